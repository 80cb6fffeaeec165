"""What counts as success, by name: one file of this room is one metric; `base` says how to write one."""

from .base import METRICS, Metric, Outcome, judge_by, known_metrics, register_metric

__all__ = ["METRICS", "Metric", "Outcome", "judge_by", "known_metrics", "register_metric"]
