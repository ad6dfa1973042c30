"""`python -m tests.golden [cases]`: compute the kept numbers anew, all or those named."""

import sys

from tests.golden.cases import CASES, computed
from tests.golden.kept import write

for case in sys.argv[1:] or CASES:
    write(case, computed(case))
    print(case)
