"""Exit codes: done; a comparison missed or a run did not reach its goal; bad input; interrupted; terminated."""

from scenarios.work.signals import INTERRUPTED as INTERRUPTED
from scenarios.work.signals import TERMINATED as TERMINATED

DONE, MISSED, BAD_INPUT = 0, 1, 2
