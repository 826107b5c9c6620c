"""Commands in turn in one job: run_commands.py JOBS, a JSON file of lists of words. A status other than 0 ends the job."""

import json
import sys
from pathlib import Path

from drillpetsc.cli import main
from tests.helpers.command import unrendered

for words in json.loads(Path(sys.argv[1]).read_text()):
    with unrendered():
        status = main(words)
    if status:
        print(f"status {status} of: {' '.join(words)}", file=sys.stderr)
        raise SystemExit(status)
