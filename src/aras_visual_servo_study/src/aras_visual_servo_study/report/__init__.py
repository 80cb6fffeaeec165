"""Result folders: summary, trace, figure, report page and video of a run."""

from .drawing import Drawing
from .report import ResultFolderError, create_result_folder, format_summary, save_results

__all__ = ["Drawing", "ResultFolderError", "create_result_folder", "format_summary", "save_results"]
