"""Error models of the filters, derived with SymPy and written to `tables/`.

Run in `models/`:

    pip install -r derivation/requirements.txt
    python -m derivation --check     # exits 1 and names the tables that are stale
    python -m derivation --update    # writes them

One file per error model. Each writes down the nonlinear model with its errors in it and differentiates at
zero error; no Jacobian is typed. Shared conventions are in `frames.py`, the format of a table in `table.py`.
"""
