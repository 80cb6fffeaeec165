"""Lists the missing dependencies of a launch file without starting it."""
