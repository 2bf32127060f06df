"""Exit codes: done; a comparison missed or a run did not reach its goal; bad input; interrupted from the keyboard."""

DONE, MISSED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
