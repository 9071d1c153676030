"""Logs as MATLAB, NumPy and HDF5 write them give the same calibration as CSV, and what is no log is refused by name.

    python check.py PROGRAM            writes files with SciPy, h5py and NumPy, runs PROGRAM on them, compares
    python check.py --fixtures FOLDER  writes the small files that `cargo test` reads
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np
import scipy.io
import scipy.sparse
import yaml

HERE = Path(__file__).resolve().parent
GOLDEN = HERE.parent / "golden" / "turns"


def table(path):
    """The columns of a CSV file by name."""
    names = path.read_text().splitlines()[0].split(",")
    values = np.genfromtxt(path, delimiter=",", skip_header=1)
    return {name: np.ascontiguousarray(values[:, index]) for index, name in enumerate(names)}


def triad(columns, name, ends="xyz"):
    return np.stack([columns[f"{name}_{end}"] for end in ends], axis=1)


def matlab73(path, variables):
    """What `save -v7.3` writes: HDF5 behind a MATLAB header, dimensions reversed, the class in an attribute."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in variables.items():
            value = np.asarray(value)
            value = value.reshape(-1, 1) if value.ndim < 2 else value
            stored = file.create_dataset(name, data=value.T, compression="gzip", chunks=True)
            stored.attrs["MATLAB_class"] = np.bytes_("double")
    text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Thu Jan  1 00:00:00 1970 HDF5 schema 1.00 ."
    with open(path, "r+b") as file:
        file.write(text.ljust(116) + bytes(8) + b"\x00\x02IM")


def hdf5(path, variables, **options):
    with h5py.File(path, "w") as file:
        for name, value in variables.items():
            # a scalar cannot be packed
            file.create_dataset(name, data=value, **(options if np.ndim(value) else {}))


def npy(path, variables):
    (value,) = variables.values()
    np.save(path, value)


WRITERS = {
    "v5.mat": lambda path, variables: scipy.io.savemat(path, variables),
    "v7.mat": lambda path, variables: scipy.io.savemat(path, variables, do_compression=True),
    "v73.mat": matlab73,
    "plain.h5": hdf5,
    "packed.h5": lambda path, variables: hdf5(
        path, variables, compression="gzip", shuffle=True, fletcher32=True, chunks=True
    ),
    "plain.npz": lambda path, variables: np.savez(path, **variables),
    "packed.npz": lambda path, variables: np.savez_compressed(path, **variables),
}


def fixtures(folder):
    """A few rows of the golden log in every format."""
    rows = 30
    columns = {name: values[:rows] for name, values in table(GOLDEN.with_suffix(".csv")).items()}
    imu = np.column_stack([triad(columns, "dtheta"), triad(columns, "dvel"), columns["time_s"]])
    names = ["dtheta_x", "dtheta_y", "dtheta_z", "dvel_x", "dvel_y", "dvel_z", "time_s"]
    lines = [",".join(names)] + [",".join(repr(float(value)) for value in row) for row in imu]
    (folder / "small.csv").write_text("\n".join(lines) + "\n")
    for ending, write in WRITERS.items():
        write(folder / f"small-{ending}", {"imu": imu})
    np.save(folder / "small.npy", np.asfortranarray(imu))
    others = {
        "wm": imu[:, :3].T,
        "vm": imu[:, 3:6],
        "t": imu[:, 6],
        "count": np.arange(rows, dtype=np.int32) - 3,
        "text": "not numbers",
        "cells": np.array([1.0, "a"], dtype=object),
        "struct": {"a": 1.0, "b": imu},
        "sparse": scipy.sparse.csc_matrix(np.eye(3)),
        "complex": imu[:, :3] * (1 + 1j),
        "flags": imu[:, :3] > 0,
        "cube": np.zeros((2, 3, 4)),
        "empty": np.zeros((0, 3)),
        "short": imu[:-1, 3:6],
    }
    scipy.io.savemat(folder / "workspace-v5.mat", others)
    scipy.io.savemat(folder / "workspace-v7.mat", others, do_compression=True)
    plain = {name: others[name] for name in ["wm", "vm", "t", "count", "complex", "flags", "cube", "empty", "short"]}
    np.savez_compressed(folder / "workspace.npz", text=np.array("not numbers"), **plain)
    with h5py.File(folder / "workspace.h5", "w") as file:
        for name, value in plain.items():
            file[name] = value
        file["text"] = "not numbers"
        file["group/t"] = imu[:, 6]


def calibrate(program, log, *options):
    command = [program, "calibrate", str(log), "--filter", "43d-b", "--json", "-", *options]
    return subprocess.run(command, capture_output=True, text=True)


def result(program, log, *options):
    run = calibrate(program, log, *options)
    if run.returncode != 0:
        raise SystemExit(f"{log.name} {' '.join(options)}: {run.stderr}")
    report = json.loads(run.stdout)
    # the only two that may differ
    del report["wall_s"], report["log"]
    return report


def close(found, expected, scale=0.0):
    """Whether two results are the same but for rounding; an estimate is compared with its sigma."""
    if isinstance(expected, dict):
        scale = expected.get("sigma") or scale
        return found.keys() == expected.keys() and all(close(found[k], expected[k], scale) for k in expected)
    if isinstance(expected, list):
        return len(found) == len(expected) and all(close(f, e, scale) for f, e in zip(found, expected))
    if isinstance(expected, float):
        return abs(found - expected) <= 1e-6 * max(abs(expected), scale, 1e-3)
    return found == expected


def check_yaml(program):
    """The exported YAML holds every estimate to the bit, and Kalibr's matrices made of them."""
    path = HERE / "calibration.json"
    command = [program, "export", str(path), "--format", "yaml"]
    exported = yaml.safe_load(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    found = {
        (name, component): (numbers["value"], numbers["sigma"])
        for name, effect in exported["parameters"].items()
        for component, numbers in effect.items()
        if component != "unit"
    }
    parameters = json.loads(path.read_text())["parameters"]
    expected = {(p["name"], p["component"]): (p["value"], p["sigma"]) for p in parameters if p["estimated"]}
    assert found == expected, "the YAML holds other numbers than the calibration"
    value = {key: value for key, (value, _) in expected.items()}
    for sensor, short in [("gyroscopes", "gyro"), ("accelerometers", "accel")]:
        for i, row in enumerate("xyz"):
            for j, column in enumerate("xyz"):
                scale, other = (f"{short}-scale", row), (f"{short}-misalignment", row + column)
                entry = 1 + value[scale] if i == j else value.get(other, 0.0)
                assert exported["imu0"][sensor]["M"][i][j] == entry
            assert exported["imu0"][sensor]["bias"][i] == value[f"{short}-bias", row]


def check(program):
    columns = table(GOLDEN.with_suffix(".csv"))
    description = GOLDEN.with_suffix(".toml").read_text()
    rate = next(float(line.split("=")[1]) for line in description.splitlines() if line.startswith("rate_hz"))
    dtheta, dvel, time = triad(columns, "dtheta"), triad(columns, "dvel"), columns["time_s"]
    imu = np.column_stack([dtheta, dvel, time])
    steps = np.diff(time, prepend=time[0] - 1 / rate)[:, None]
    done = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def write(file, variables):
            log = folder / file
            log.with_suffix(".toml").write_text(description)
            WRITERS.get(file.split("-", 1)[1], npy)(log, variables)
            return log

        def csv(file, variables):
            log = folder / file
            log.with_suffix(".toml").write_text(description)
            rows = zip(*variables.values())
            lines = [",".join(variables)] + [",".join(map(repr, map(float, row))) for row in rows]
            log.write_text("\n".join(lines) + "\n")
            return log

        names = ["dtheta_x", "dtheta_y", "dtheta_z", "dvel_x", "dvel_y", "dvel_z", "time_s"]
        whole = result(program, GOLDEN.with_suffix(".csv"))
        bare = result(program, csv("bare.csv", dict(zip(names, imu.T))))
        foreign = {"t": time, "wm": dtheta, "vm": dvel.T, "other": np.arange(3.0)}
        rates = {"t": time, "w": np.degrees(dtheta / steps), "f": dvel / steps / 9.80665}
        turned = np.column_stack([dtheta[:, 1], dtheta[:, 0], -dtheta[:, 2]])
        for ending in WRITERS:
            exact = [
                (write(f"names-{ending}", columns), [], whole),
                (write(f"psins-{ending}", {"imu": imu}), [], bare),
                (write(f"beside-{ending}", {"imu": imu, "avp0": np.arange(9.0), "ts": 0.01}), [], bare),
                (write(f"foreign-{ending}", foreign), ["--map", "gyro=wm,accel=vm,time=t"], bare),
                (
                    write(f"turned-{ending}", {"imu": imu, "w": turned}),
                    ["--map", "dtheta_x=w[1],dtheta_y=w[0]", "--map", "dtheta_z=-w[2]"],
                    bare,
                ),
            ]
            for log, options, expected in exact:
                found = result(program, log, *options)
                assert found == expected, f"{log.name}: another calibration than of the CSV file"
                done += 1
            found = result(program, write(f"rates-{ending}", rates), "--map", "gyro=w:deg/s,accel=f:g,time=t")
            assert close(found, bare), f"rates-{ending}: another calibration than of increments"
            done += 1
        assert result(program, write("single-imu.npy", {"imu": imu})) == bare
        table_of_others = {f"w{end}": values for end, values in zip("xyz", dtheta.T)}
        table_of_others |= {f"f [{end}]": values for end, values in zip("xyz", dvel.T)} | {"t": time}
        others = csv("others.csv", table_of_others)
        mapped = "gyro=w,dvel_x=f [x],dvel_y=f [y],dvel_z=f [z],time=t"
        assert result(program, others, "--map", mapped) == bare
        done += 2
        # the errors taken out: of NumPy and MATLAB files as of the table of text
        calibration = folder / "c.json"
        calibration.write_text(calibrate(program, folder / "bare.csv").stdout)

        def applied(log, *options):
            out = folder / f"applied-{log.name}"
            command = [program, "apply", str(log), "--calibration", str(calibration), "--out", str(out), *options]
            subprocess.run(command, capture_output=True, check=True)
            return out

        corrected = table(applied(folder / "bare.csv"))
        gyro, accel = triad(corrected, "dtheta"), triad(corrected, "dvel")
        assert np.abs(gyro - dtheta).max() > 0
        for ending in ["plain.npz", "packed.npz"]:
            mapped = ["--map", "gyro=wm,accel=vm,time=t"]
            with np.load(applied(folder / f"foreign-{ending}", *mapped)) as found:
                assert set(found) == set(foreign) and np.array_equal(found["other"], foreign["other"])
                assert np.abs(found["wm"] - gyro).max() < 1e-15 and np.abs(found["vm"] - accel.T).max() < 1e-13
            done += 1
        for ending in ["v5.mat", "v7.mat"]:
            found = scipy.io.loadmat(applied(folder / f"foreign-{ending}", *mapped))
            assert np.array_equal(found["other"].ravel(), foreign["other"]) and found["wm"].shape == gyro.shape
            assert np.abs(found["wm"] - gyro).max() < 1e-15 and np.abs(found["vm"] - accel.T).max() < 1e-13
            done += 1
        found = np.load(applied(folder / "single-imu.npy"))
        assert np.abs(found - np.column_stack([gyro, accel, time])).max() < 1e-13
        done += 1
        assert calibrate(program, GOLDEN.with_suffix(".csv"), "--map", "gyr=w").returncode == 2
        for ending, name in [("v7.mat", "avp"), ("packed.npz", "avp"), ("packed.h5", "avp")]:
            run = calibrate(program, write(f"missing-{ending}", foreign), "--map", f"gyro={name},accel=vm,time=t")
            assert run.returncode == 1 and f"`{name}`: is not in the file" in run.stderr, run.stderr
            done += 1
    check_yaml(program)
    print(f"{done} files read as their CSV, or refused by name")


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--fixtures":
        fixtures(Path(sys.argv[2]))
    elif len(sys.argv) == 2:
        check(sys.argv[1])
    else:
        raise SystemExit(__doc__)
