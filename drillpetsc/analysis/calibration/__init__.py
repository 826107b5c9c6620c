"""Numbers of a case from readings: the estimator, and the fit of runs to series in time."""
