"""Many runs: where they start, running them on every core, storing, judging and showing them."""
