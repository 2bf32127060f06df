"""What is kept: the run folder and the writing of files, whole or not at all."""
