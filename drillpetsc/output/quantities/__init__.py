"""Outputs that need more than one component: a module for each file or measurement.

Plain descriptions, like ``drillpetsc.physics.quantities``: no PETSc and no compiled kernels.  A value is a function of
the source that declares it (a class of ``drillpetsc.output``) and of the sample.  Signs: manual, sec-conventions-signs.
"""
