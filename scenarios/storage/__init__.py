"""What is kept: the run folder, and the writing of files, whole or not at all. Knows no measure and no picture."""

__all__ = ["again", "files", "manifest", "result_schema", "run_folder", "scratch", "script_folder", "states"]
