"""One run: the sequence of an experiment, the loop in process, its record and its judgement."""
