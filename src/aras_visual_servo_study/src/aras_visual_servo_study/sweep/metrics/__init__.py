"""What counts as success, by name: one file of this room is one metric; `base` says how to write one."""

from .base import Metric, Outcome, judge_by, known_metrics, metric, register_metric

__all__ = ["Metric", "Outcome", "judge_by", "known_metrics", "metric", "register_metric"]
