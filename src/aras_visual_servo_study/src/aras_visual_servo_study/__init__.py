"""Studies of visual servoing: sweeps, comparisons, benchmarks, reports and the live page."""
