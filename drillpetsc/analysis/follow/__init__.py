"""Follow a rig: friction, weights and reading errors estimated row by row, a forecast one stand ahead, and alarms."""
