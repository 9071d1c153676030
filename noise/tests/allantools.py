"""Overlapping Allan deviations by allantools, an implementation that is not ours.

    pip install allantools==2024.6 numpy
    python allantools.py            prints the figures that noise/tests/allan.rs holds
    python allantools.py PROGRAM    has PROGRAM measure the noise of series and compares all of its deviations
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.pop(0)  # this file has the name of the package
import allantools  # noqa: E402
import allantools.ci  # noqa: E402

RATE = 50.0


def series(count):
    """Numbers that any language makes alike: a generator of Knuth, the running sum of its output, and the output itself."""
    state, walk, readings = 1, 0.0, []
    for _ in range(count):
        state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
        uniform = (state >> 11) / 2**53 - 0.5
        walk += 0.01 * uniform
        readings.append(uniform + walk)
    return np.array(readings)


def deviations(readings, rate=RATE):
    octaves = 2 ** np.arange(int(np.log2(len(readings) / 2)) + 1)
    return allantools.oadev(readings, rate=rate, data_type="freq", taus=octaves / rate)


def compare(program):
    random = np.random.default_rng(7)
    count = 30_000
    time = np.arange(1, count + 1) / RATE
    noise = random.normal(size=(count, 6)) * 1e-3
    noise[:, 1] += np.cumsum(random.normal(size=count)) * 2e-6
    noise[:, 2] = np.diff(np.round(np.cumsum(noise[:, 2]) / 1e-3), prepend=0) * 1e-3
    noise[:, 4] += 1e-8 * np.arange(count)
    readings = noise + [0.01, -0.02, 0.03, 0.1, -0.2, 9.81]
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "still.csv"
        np.savetxt(log, np.column_stack([time, readings]), delimiter=",", fmt="%.17g",
                   header="t,wx,wy,wz,ax,ay,az", comments="")
        out = Path(folder) / "noise"
        command = [program, "noise", log, "--map", "gyro=w:rad/s,accel=a:m/s^2,time=t", "--out", out]
        subprocess.run(list(map(str, command)), check=True, capture_output=True)
        found = json.loads((out / "noise.json").read_text())
        export = [program, "export", out / "noise.json", "--format", "kalibr"]
        kalibr = subprocess.run(list(map(str, export)), check=True, capture_output=True, text=True).stdout
    compared = 0
    for sensor, first in (("gyro", 0), ("accel", 3)):
        for axis, entry in enumerate(found[sensor]):
            taus, expected, _, _ = deviations(readings[:, first + axis] - readings[0, first + axis])
            for point, tau, deviation in zip(entry["allan"], taus, expected):
                assert abs(point["tau_s"] / tau - 1) < 1e-9, (sensor, axis, point, tau)
                # steps of the stamps are rounded to 1e-16 of some hundred seconds: 1e-12 of a step
                assert abs(point["deviation"] / deviation - 1) < 1e-10, (sensor, axis, point, deviation)
                if point["edf"] > 2:
                    low, high = allantools.ci.confidence_interval(deviation, point["edf"], ci=0.95)
                    assert abs(point["low"] / low - 1) < 1e-9 and abs(point["high"] / high - 1) < 1e-9, point
                compared += 1
    names = ["accelerometer_noise_density", "accelerometer_random_walk", "gyroscope_noise_density",
             "gyroscope_random_walk", "rostopic", "update_rate"]
    assert sorted(line.split(":")[0] for line in kalibr.splitlines() if not line.startswith("#")) == names, kalibr
    print(f"{compared} Allan deviations are those of allantools to 1e-10, and their bounds")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        compare(sys.argv[1])
    else:
        for tau, deviation, _, terms in zip(*deviations(series(2000))):
            print(f"({round(tau * RATE)}, {float(deviation)!r}, {round(terms)}),")
