"""`python -m derivation --check | --update`, run in `models/`."""

import argparse
import importlib
import sys
from pathlib import Path

HERE = Path(__file__).parent
TABLES = HERE.parent / "tables"


def pinned_version():
    for line in (HERE / "requirements.txt").read_text().split():
        if line.startswith("sympy=="):
            return line.removeprefix("sympy==")
    sys.exit("derivation/requirements.txt pins no SymPy")


def derive():
    """File name -> text of every table."""
    from . import frames

    frames.check_identities()
    tables = {}
    for path in sorted(HERE.glob("effects/*.py")) + sorted(HERE.glob("strapdown/*.py")):
        if path.stem.startswith("_"):
            continue
        module = importlib.import_module(f"{__package__}.{path.parent.name}.{path.stem}")
        table = module.table()
        table.origin = f"derivation/{path.parent.name}/{path.name}"
        tables[f"{table.name}.toml"] = table.text()
    return tables


def main():
    parser = argparse.ArgumentParser(prog="python -m derivation", description=__doc__)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--check", action="store_true", help="exit with 1 if a table is stale")
    what.add_argument("--update", action="store_true", help="write the tables")
    arguments = parser.parse_args()

    import sympy

    if sympy.__version__ != pinned_version():
        sys.exit(f"SymPy {sympy.__version__} is installed, the tables are made with {pinned_version()}")
    tables = derive()
    there = {path.name: path.read_text() for path in TABLES.glob("*.toml")}
    stale = sorted(name for name in tables.keys() | there.keys() if tables.get(name) != there.get(name))
    for name in stale:
        state = "missing" if name not in there else "not derived any more" if name not in tables else "stale"
        print(f"tables/{name}: {state}")
    if arguments.update:
        TABLES.mkdir(exist_ok=True)
        for name in stale:
            if name in tables:
                (TABLES / name).write_text(tables[name])
            else:
                (TABLES / name).unlink()
    elif stale:
        sys.exit("run `python -m derivation --update` in models/ and review the difference")


if __name__ == "__main__":
    main()
