"""Run one stage of the pipeline; the rules of the Snakefile call it.

The stage writes its files, and then its manifest: the hashes of what it wrote and read, and what
it was made of.
"""

import argparse
import sys
from pathlib import Path

from gearmesh.data import manifest
from gearmesh.data.paths import Places
from gearmesh.errors import InputError
from gearmesh.garbage import search_rarely
from gearmesh.pipeline.locks import job
from gearmesh.pipeline.messages import BAD_INPUT, say
from gearmesh.pipeline.stages import STAGES, job_name
from gearmesh.study.loading import load_study


def main() -> None:
    """Run as a job."""
    search_rarely()
    parser = argparse.ArgumentParser(prog="python -m gearmesh.pipeline", description=__doc__)
    parser.add_argument("stage", choices=STAGES, metavar="STAGE", help=", ".join(STAGES))
    parser.add_argument("study", type=Path, help="the file of the study")
    parser.add_argument("made_of", help="digest for the manifest; '-' writes none")
    parser.add_argument("arguments", nargs="*", help="which job of the stage, such as a letter")
    parser.add_argument("--read", type=Path, nargs="*", default=[], help="results that it reads")
    options = parser.parse_args()
    try:
        study = load_study(options.study)
        places = Places(study.name)
        with job(places):
            written = STAGES[options.stage](study, places, *options.arguments)
            if options.made_of != "-":
                path = places.manifest(job_name(options.stage, *options.arguments))
                manifest.write(path, places.folder, options.made_of, written, options.read)
    except InputError as error:
        say(f"error: {error}")
        sys.exit(BAD_INPUT)


if __name__ == "__main__":
    main()
