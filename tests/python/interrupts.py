"""Ctrl-C reaches every call that is running and the main thread, and nothing unfinished is returned as finished."""

import os
import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
DUFFING = ROOT / "models/duffing/duffing.sysid"

HEAD = f"""
import os, signal, threading, time
import numpy as np
import sysid

def press(seconds):
    timer = threading.Timer(seconds, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    return timer

def outcome(work):
    try:
        return work()
    except KeyboardInterrupt:
        return None

text = open({str(DUFFING)!r}).read()
model = sysid.loads(text, folder={str(DUFFING.parent)!r})
"""


class Interrupts(unittest.TestCase):
    def printed(self, program):
        with tempfile.TemporaryDirectory() as folder:
            said = subprocess.run(
                [sys.executable, "-c", HEAD + textwrap.dedent(program)], capture_output=True, text=True, cwd=folder, timeout=300
            )
        return said.stdout, said.stderr

    def test_all_threads_hear_it(self):
        out, error = self.printed(
            """
            theta = model.sample_prior(8000, seed=1)
            values = model.constrain(theta[:1500])
            calls = {
                "log_density": lambda: model.log_density(theta),
                "gradient": lambda: model.gradient(theta[:3000]),
                "residuals": lambda: model.residuals(theta[:3000]),
                "simulate": lambda: model.simulate(values).values["displacement"],
            }
            for name, call in calls.items():
                call()  # reads the data
                start = time.monotonic()
                expected = call()
                duration = time.monotonic() - start
                for attempt in range(20):  # all of them may be between two calls, or storing their arrays
                    found = {}
                    work = lambda i: found.__setitem__(i, outcome(lambda: [call() for _ in range(5)]))
                    threads = [threading.Thread(target=work, args=(i,)) for i in range(3)]
                    told = 0
                    try:
                        for thread in threads:
                            thread.start()
                        time.sleep(2 * duration)  # of fifteen
                        os.kill(os.getpid(), signal.SIGINT)
                        time.sleep(10)
                    except KeyboardInterrupt:
                        told += 1
                    for thread in threads:
                        thread.join()
                    given_up = [each is None for each in found.values()]
                    right = all(np.array_equal(one, expected, equal_nan=True) for each in found.values() if each for one in each)
                    if any(given_up) or told != 1 or not right:
                        break
                print(name, told, any(given_up), right, len(found))
                print(np.array_equal(call(), expected, equal_nan=True))  # nothing is left pending
            """
        )
        expected = "".join(f"{name} 1 True True 3\nTrue\n" for name in ("log_density", "gradient", "residuals", "simulate"))
        self.assertEqual(out, expected, error)

    def test_what_is_given_up_counts_no_failures(self):
        out, error = self.printed(
            """
            theta = np.repeat(model.sample_prior(20000, seed=1), 10, axis=0)
            before = model.failures
            press(0.1)
            print(outcome(lambda: [model.log_density(theta) for _ in range(50)][0]) is None)
            one = sysid.loads(text, folder=%r)
            one.log_density(theta)
            counted = sum(each["count"] for each in model.failures)
            whole = sum(each["count"] for each in one.failures)
            print(before == [], counted == 0 or (whole > 0 and counted %% whole == 0))
            """
            % str(DUFFING.parent)
        )
        self.assertEqual(out, "True\nTrue True\n", error)

    def test_a_fit_in_one_thread_and_a_density_in_the_main_thread(self):
        out, error = self.printed(
            """
            theta = np.repeat(model.sample_prior(20000, seed=1), 5, axis=0)
            expected = model.log_density(theta)
            found = []

            def fit():
                try:
                    found.append(model.fit(seed=2, progress=False))
                except KeyboardInterrupt:
                    found.append(None)

            thread = threading.Thread(target=fit)
            thread.start()
            press(0.4)
            told = False
            try:
                while thread.is_alive():
                    if not np.array_equal(model.log_density(theta), expected):
                        print("wrong values")
            except KeyboardInterrupt:
                told = True
            thread.join()
            print(told, found[0] is None or found[0].interrupted)
            print(np.array_equal(model.log_density(theta), expected))
            """
        )
        self.assertEqual(out, "True True\nTrue\n", error)

    def test_one_that_comes_too_late_to_stop_a_task(self):
        out, error = self.printed(
            """
            import pathlib

            def files(result):
                return {name: (result.folder / name).read_bytes() for name in result.files if name.endswith((".csv", "mary.json"))}

            def press_when_draws_are_written():
                while not pathlib.Path("late/posterior/draws_1.csv").exists():
                    time.sleep(1e-4)
                os.kill(os.getpid(), signal.SIGINT)

            whole = model.fit(seed=3)
            threading.Thread(target=press_when_draws_are_written).start()
            done = []
            try:
                for seed in (3, 4):
                    done.append(model.fit(seed=seed, output="late", force=True))
            except KeyboardInterrupt as raised:
                print(done, raised)
            late = model.results["posterior"]
            print(late.interrupted, late.summary["seed"], late is not whole, files(late) == files(whole))
            """
        )
        self.assertEqual(
            out,
            "[] `posterior` ended before the interruption took effect: its result is in model.results['posterior']\nFalse 3 True True\n",
            error,
        )

    def test_a_handler_of_the_program_comes_back(self):
        out, error = self.printed(
            """
            theta = model.sample_prior(20000, seed=1)
            told = []
            signal.signal(signal.SIGINT, lambda number, frame: told.append(number))
            model.log_density(theta)
            os.kill(os.getpid(), signal.SIGINT)
            print(told == [signal.SIGINT])
            """
        )
        self.assertEqual(out, "True\n", error)


if __name__ == "__main__":
    unittest.main()
