"""Tasks from Python: the command line's bytes, results as xarray has them, Ctrl-C, progress, pickles."""

import contextlib
import io
import json
import os
import pathlib
import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
import unittest
import warnings

import numpy as np

import sysid

ROOT = pathlib.Path(__file__).resolve().parents[2]

DECAY = """model decay {
  state y [m]
  initial y = 1 [m]
  parameter rate  [1/s] ~ log_uniform(0.1, 10)
  parameter noise [m]   ~ log_uniform(1e-3, 1)
  y' = -rate*y
  observe d ~ normal(y, sd = noise)
  derive half [s] = log(2)/rate
}
data bench {
  file    "bench.csv"
  time    t [s]
  measure d = d [m]
  split   train = rows 1..30, test = rows 31..40
}
posterior = fit decay to bench.train with mh(samples = 400, burn_in = 100, thin = 1, chains = 2), seed = 1
forecast  = predict posterior on bench.test with draws(20), seed = 1
"""
T = np.arange(40) * 0.05
D = np.exp(-1.3 * T) + 0.02 * np.cos(23 * np.arange(40))


def files_of(folder):
    """What lies in a folder of results, but for how long it took."""
    paths = sorted(path for path in pathlib.Path(folder).rglob("*") if path.is_file() and path.name != "timing.json")
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths}


class Desk(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        before = os.getcwd()
        os.chdir(self.folder.name)
        self.addCleanup(os.chdir, before)
        pathlib.Path("decay.sysid").write_text(DECAY)
        pathlib.Path("bench.csv").write_text("t,d\n" + "".join(f"{t!r},{d!r}\n" for t, d in zip(T.tolist(), D.tolist())))

    def command_line(self, *arguments):
        said = subprocess.run([os.environ["SYSID_PROGRAM"], *arguments], capture_output=True, text=True)
        self.assertIn(said.returncode, (0, 1), said.stderr)
        return said.stdout


class Bytes(Desk):
    def test_fit_and_predict_equal_the_command_line(self):
        said = self.command_line("run", "decay.sysid", "--seed", "7", "--no-figures", "--quiet")
        model = sysid.load("decay.sysid")
        shutil.move("results", "of_command_line")
        fit = model.fit(seed=7, output="results")
        forecast = model.predict(seed=7, output="results")
        for task in ("posterior", "forecast"):
            expected, found = files_of(f"of_command_line/{task}"), files_of(f"results/{task}")
            self.assertEqual(list(found), list(expected))
            for name in expected:
                self.assertEqual(found[name], expected[name], f"{task}/{name} differs")
        self.assertEqual(fit.text + forecast.text, said)
        self.assertEqual(fit.folder, pathlib.Path("results/posterior"))

    def test_arrays_give_the_draws_of_the_file(self):
        fits = [sysid.load("decay.sysid", data=data).fit() for data in (None, {"t": T, "d": D})]
        for name in ("draws_1.csv", "draws_2.csv"):
            # But for the head, which names the table.
            rows = [[line for line in (fit.folder / name).read_text().splitlines() if not line.startswith("#")] for fit in fits]
            self.assertEqual(len(rows[0]), 301)
            self.assertEqual(*rows)

    def test_arrays_name_no_temporary_table(self):
        fits = [sysid.load("decay.sysid", data={"t": T, "d": D}).fit() for _ in range(2)]
        self.assertEqual(files_of(fits[0].folder), files_of(fits[1].folder))
        self.assertIn("bench (arrays)", (fits[0].folder / "draws_1.csv").read_text())
        self.assertEqual(fits[0].summary["data"][0]["file"], "bench (arrays)")
        check = sysid.load("decay.sysid", data={"t": T, "d": D}).check(seed=1)
        self.assertIn("bench (arrays): rows 1..30", check.text)
        with self.assertRaisesRegex(sysid.Error, r"`bench \(arrays\)` row 2 \(index 1\), column `t`: time does not increase") as caught:
            sysid.load("decay.sysid", data={"t": T[::-1], "d": D}).fit()
        self.assertIn("row 2 (index 1)", caught.exception.diagnostics[0]["message"])
        for text in (str(caught.exception), caught.exception.help):
            self.assertIn("if there are two runs, give each a data block of its own", text)
            self.assertNotIn("file", text.partition("help: ")[2])

    def test_the_file_of_export(self):
        self.command_line("run", "decay.sysid", "--no-figures", "--quiet")
        self.command_line("export", "results")
        model = sysid.load("decay.sysid")
        fit = model.fit(output="results", force=True)
        model.predict(output="results", force=True)
        fit.to_netcdf("again.nc")
        self.command_line("run", "decay.sysid", "--no-figures", "--quiet", "--force")
        self.command_line("export", "results")
        self.assertEqual(pathlib.Path("again.nc").read_bytes(), pathlib.Path("results/posterior/posterior.nc").read_bytes())


class Words(Desk):
    def test_advice_is_what_python_has(self):
        text = DECAY.replace("-rate*y", "-rate").replace("half [s] = log(2)/rate", "half [s] = log(2)*1[s]").replace("[1/s] ~", "[m/s] ~")
        pathlib.Path("wrong.sysid").write_text(text)
        fit = sysid.load("wrong.sysid").fit()
        self.assertIn("sysid explain", fit.text)  # the command line's
        for shown in (repr(fit), str(fit), repr(fit.findings)):
            self.assertNotIn("sysid explain", shown)
            self.assertNotIn("--", shown.replace("---", ""))
            self.assertNotIn("at the prompt", shown)
        self.assertIn("more: sysid.explain(", repr(fit))


class Results(Desk):
    def test_groups(self):
        model = sysid.load("decay.sysid")
        fit = model.fit()
        self.assertEqual(set(fit.posterior.data_vars), {"rate", "noise", "half"})
        self.assertEqual(dict(fit.posterior.sizes), {"chain": 2, "draw": 300})
        self.assertEqual(fit.posterior.rate.attrs["units"], "1/s")
        np.testing.assert_allclose(fit.posterior.half, np.log(2) / fit.posterior.rate, rtol=1e-12)
        self.assertEqual(fit.log_likelihood.d.shape[-1], 30)
        np.testing.assert_allclose(fit.observed_data.d, D[:30])
        for name in ("sample_stats", "posterior_predictive", "prior", "prior_predictive"):
            self.assertIn(name, fit.groups())
        with self.assertRaisesRegex(AttributeError, "no group 'predictions'"):
            fit.predictions
        with self.assertRaises(AttributeError):
            fit.nothing
        forecast = model.predict()
        self.assertEqual(list(forecast.groups()), ["predictions", "predictions_constant_data"])
        self.assertEqual(dict(forecast.predictions.sizes), {"row": 10, "chain": 1, "draw": 20})
        self.assertEqual(list(forecast.predictions.row.values), list(range(31, 41)))
        self.assertFalse(hasattr(forecast, "posterior"))
        # No more than the draws that there are.
        many = fit.groups(draws=10**6)
        self.assertEqual(dict(many["log_likelihood"].sizes)["draw"], 300)
        self.assertEqual(dict(many["prior"].sizes), {"chain": 1, "draw": 600})
        self.assertEqual(list(fit.groups(draws=0)), ["posterior", "sample_stats"])
        for call in (fit.groups, lambda draws: fit.to_netcdf("none.nc", draws)):
            with self.assertRaisesRegex(ValueError, "draws is a whole number from 0"):
                call(draws=-1)
        with self.assertRaisesRegex(TypeError, "draws is a whole number"):
            fit.groups(draws=2.5)
        self.assertTrue(hasattr(forecast, "predictions"))
        forecast.to_netcdf("forecast.nc")
        again = pickle.loads(pickle.dumps(forecast))
        self.assertTrue(again.predictions.equals(forecast.predictions))
        # Draws have the density that the model as a function gives.
        log_prior = fit.sample_stats.log_prior.values[0]
        values = np.stack([fit.posterior[name].values[0] for name in model.names], axis=1)
        self.assertEqual(values.shape, (300, 2))
        density = model.prepare(seed=1).log_density(values, declared=True, part="likelihood")
        np.testing.assert_allclose(density, fit.sample_stats.log_likelihood.values[0], rtol=1e-9)
        self.assertEqual(log_prior.shape, (300,))

    def test_summary(self):
        fit = sysid.load("decay.sysid").fit()
        self.assertEqual(list(fit.parameters), ["rate", "noise", "half"])
        self.assertAlmostEqual(fit.parameters["rate"]["mean"], 1.3, delta=0.1)
        self.assertIn("verdict", fit.text)
        self.assertFalse(fit.interrupted)
        self.assertIn("draws_1.csv", fit.files)
        self.assertEqual(len(fit.table("draws_1.csv")), 300)

    def test_pickle(self):
        fit = sysid.load("decay.sysid").fit()
        again = pickle.loads(pickle.dumps(fit))
        self.assertNotEqual(again.folder, fit.folder)
        self.assertEqual(files_of(again.folder), files_of(fit.folder))
        self.assertTrue(again.posterior.equals(fit.posterior))
        self.assertEqual(again.text, fit.text)

    def test_a_pickle_has_no_other_files_of_the_folder(self):
        pathlib.Path("other").mkdir()
        pathlib.Path("other/record.csv").write_text("t\n0\n")
        pathlib.Path("notes.txt").write_text("mine")
        fit = sysid.load("decay.sysid").fit(output=".")
        again = pickle.loads(pickle.dumps(fit))
        self.assertEqual([each.name for each in again.folder.parent.iterdir()], [fit.task])
        self.assertEqual(files_of(again.folder), files_of(fit.folder))

    def test_pickle_with_arrays(self):
        model = sysid.load("decay.sysid", data={"t": T, "d": D})
        kept = pickle.dumps(model.fit())
        del model
        os.remove("decay.sysid")
        np.testing.assert_allclose(pickle.loads(kept).observed_data.d, D[:30])

    def test_a_pickle_has_the_files_of_tasks_alone(self):
        model = sysid.load("decay.sysid")
        fit = model.fit(output=".")
        expected = files_of(fit.folder)
        os.mkdir("photographs")
        pathlib.Path("photographs/large.bin").write_bytes(b"sysid" * 10**5)
        kept = pickle.dumps(fit)
        self.assertLess(len(kept), sum(map(len, expected.values())) + 10**5)
        again = pickle.loads(kept)
        self.assertEqual(files_of(again.folder.parent), {f"posterior/{name}": content for name, content in expected.items()})
        self.assertTrue(again.posterior.equals(fit.posterior))
        shutil.rmtree("posterior")
        with self.assertRaisesRegex(FileNotFoundError, "the files of `posterior` are no longer in posterior"):
            pickle.dumps(fit)

    def test_results_stay_where_they_are(self):
        model = sysid.load("decay.sysid")
        fit = model.fit(output="results")
        expected, rate = files_of(fit.folder), fit.parameters["rate"]["mean"]
        os.mkdir("inner")
        os.chdir("inner")
        self.addCleanup(os.chdir, self.folder.name)
        self.assertEqual(fit.parameters["rate"]["mean"], rate)
        self.assertEqual(files_of(fit.folder), expected)
        again = pickle.loads(pickle.dumps(fit))
        self.assertEqual(files_of(again.folder), expected)
        self.assertIn("log_likelihood", fit.groups())
        # A task that replaces them is told so wherever it is called.
        model.fit(output="../results", force=True, seed=8)
        self.assertEqual(files_of(fit.folder), expected)
        self.assertNotEqual(files_of("../results/posterior"), expected)

    def test_check_and_compare(self):
        model = sysid.load("decay.sysid")
        check = model.check(seed=1)
        self.assertEqual(check.text, self.command_line("check", "decay.sysid", "--seed", "1"))
        self.assertIn("models", check.content)
        fit = model.fit()
        self.assertIn("decay", sysid.compare(fit).text)
        other = model.fit(seed=2)
        for shown in (sysid.compare(fit, other).text, json.dumps(sysid.compare(fit, other).content)):
            self.assertIn("posterior (1)", shown)
            self.assertIn("posterior (2)", shown)
            self.assertNotIn(str(fit.folder), shown)
            self.assertNotIn(str(other.folder), shown)
        with self.assertRaises(sysid.Error):
            sysid.compare("nowhere")

    def test_names_beyond_ascii_are_read_as_the_engine_writes_them(self):
        program = textwrap.dedent(
            """
            import json, sysid
            text = open("decay.sysid", encoding="utf-8").read().replace("[m]", "[\\u00b5m]")
            fits = [sysid.loads(text).fit(seed=seed) for seed in (1, 2)]
            print(ascii(fits[0].parameters["noise"]["unit"]))
            shown = json.dumps(sysid.compare(*fits).content, ensure_ascii=False)
            print(any(str(fit.folder) in shown for fit in fits))
            """
        )
        pathlib.Path("f\u00fcr").mkdir()
        for settings in ({"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}, {"PYTHONUTF8": "1", "TMPDIR": "f\u00fcr"}):
            said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env={**os.environ, **settings})
            self.assertEqual(said.stdout, "'\\xb5m'\nFalse\n", said.stderr)

    def test_refusals(self):
        model = sysid.load("decay.sysid")
        with self.assertRaisesRegex(sysid.Error, "no select task"):
            model.select()
        with self.assertRaisesRegex(sysid.Error, "no fit task `forecast`"):
            model.fit("forecast")
        with self.assertRaises(sysid.Error) as caught:
            model.predict(output="empty")
        self.assertEqual(caught.exception.code, "E6202")
        self.assertIn('run the fit first: model.fit(output="empty")\n', str(caught.exception))
        self.assertIn('more: sysid.explain("E6202")', str(caught.exception))
        self.assertTrue(sysid.explain("E6202").startswith("E6202: "))
        model.fit(output="results")
        with self.assertRaises(sysid.Error) as caught:
            model.fit(output="results")
        self.assertEqual(caught.exception.help, "add force=True to replace them, or output=DIR to write elsewhere")
        self.assertIn(caught.exception.help, str(caught.exception))
        with self.assertRaisesRegex(sysid.Error, "no message `E9999`"):
            sysid.explain("E9999")

    def test_options_that_are_none(self):
        model = sysid.load("decay.sysid")
        for call in (model.fit, model.prepare, model.check, lambda seed: model.sample_prior(1, seed)):
            for seed in (-1, 2**64):
                with self.assertRaisesRegex(ValueError, "seed is a whole number from 0 to 18446744073709551615"):
                    call(seed=seed)
            with self.assertRaisesRegex(TypeError, "seed is a whole number, not 1.5"):
                call(seed=1.5)
        with self.assertRaisesRegex(ValueError, "threads is a whole number from 0"):
            sysid.load("decay.sysid", threads=-1)
        with self.assertRaisesRegex(TypeError, "threads is a whole number, not 1.5"):
            sysid.load("decay.sysid", threads=1.5)
        with self.assertRaisesRegex(TypeError, "figures is True or False, not 'x'"):
            model.fit(figures="x")
        with self.assertRaisesRegex(ValueError, "checkpoint_interval is a number of seconds"):
            model.fit(checkpoint_interval=-1)
        with self.assertRaisesRegex(TypeError, "at least one result"):
            sysid.compare()

    def test_progress(self):
        with contextlib.redirect_stderr(io.StringIO()) as said:
            sysid.load("decay.sysid").fit(progress=True)
        self.assertIn("\r", said.getvalue())
        with contextlib.redirect_stderr(io.StringIO()) as said:
            sysid.load("decay.sysid").fit(progress=False)
        self.assertEqual(said.getvalue(), "")


class OfItsOwn(Desk):
    """A result is of its own run, whatever is run afterwards."""

    def test_a_later_fit_changes_no_earlier_result(self):
        model = sysid.load("decay.sysid")
        for options in ({}, {"output": "results", "force": True}):
            first = model.fit(seed=7, **options)
            rate, said, files = first.parameters["rate"]["mean"], first.text, files_of(first.folder)
            second = model.fit(seed=8, **options)
            self.assertNotEqual(second.parameters["rate"]["mean"], rate)
            self.assertEqual((first.parameters["rate"]["mean"], first.text, files_of(first.folder)), (rate, said, files))
            self.assertEqual(int(first.posterior.attrs["seed"]), 7)
            self.assertEqual(int(pickle.loads(pickle.dumps(first)).posterior.attrs["seed"]), 7)
            self.assertEqual(model.results["posterior"], second)
        self.assertEqual(second.folder, pathlib.Path("results/posterior"))

    def test_a_prediction_is_from_the_draws_of_the_last_fit(self):
        model = sysid.load("decay.sysid")
        model.fit(seed=7)
        early = model.predict()
        kept = files_of(early.folder)
        model.fit(seed=8)
        late = model.predict()
        self.assertNotEqual(files_of(late.folder)["predict.csv"], kept["predict.csv"])
        self.assertEqual(files_of(early.folder), kept)
        other = sysid.load("decay.sysid")
        other.fit(seed=8, output="elsewhere")
        self.assertEqual(files_of(other.predict().folder)["predict.csv"], files_of(late.folder)["predict.csv"])

    def test_an_interrupted_fit_gives_no_numbers_of_an_earlier_one(self):
        program = textwrap.dedent(
            """
            import os, signal, sysid, sysid._progress

            class Tell:
                armed = False
                def begin(self, what, total):
                    if self.armed: os.kill(os.getpid(), signal.SIGINT)
                def expect(self, total): pass
                def advance(self, done, note): pass
                def end(self, finished): pass

            sysid._progress.line_for = lambda wanted: Tell()
            model = sysid.load("decay.sysid")
            for options in ({}, {"output": "results", "force": True}):
                Tell.armed = False
                first = model.fit(seed=7, **options)
                rate = first.parameters["rate"]["mean"]
                Tell.armed = True
                try:
                    second = model.fit(seed=8, **options)
                    print(second.interrupted, second.summary["seed"], second.parameters["rate"]["mean"] != rate)
                except KeyboardInterrupt:
                    print("interrupted")
                print(first.parameters["rate"]["mean"] == rate)
                Tell.armed = False
                print(model.fit(seed=8, resume=True, **{**options, "force": False}).summary["seed"])
            """
        )
        said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        self.assertEqual(said.stdout, "interrupted\nTrue\n8\n" * 2, said.stderr)


class OtherTasks(Desk):
    def test_select(self):
        text = """model straight { input u\n parameter a ~ normal(0, sd = 5)\n observe d ~ normal(a*u, sd = 0.1) }
model bent { input u\n parameter a ~ normal(0, sd = 5)\n parameter b ~ normal(0, sd = 5)
  observe d ~ normal(a*u + b*u^2, sd = 0.1) }
data bench { file "line.csv"; input u = u; measure d = d }
candidates shapes { straight\n bent }
choice = select shapes to bench with reversible_jump, seed = 1
"""
        pathlib.Path("line.sysid").write_text(text)
        u = np.linspace(0, 1, 30)
        d = 2 * u + 0.1 * np.cos(37 * u)
        pathlib.Path("line.csv").write_text("u,d\n" + "".join(f"{a!r},{b!r}\n" for a, b in zip(u.tolist(), d.tolist())))
        said = self.command_line("select", "line.sysid", "--quiet", "--no-figures")
        shutil.move("results", "of_command_line")
        choice = sysid.load("line.sysid").select(output="results")
        self.assertEqual(choice.text, said)
        self.assertEqual(files_of("results/choice"), files_of("of_command_line/choice"))
        self.assertGreater(choice.summary["models"]["straight"]["probability"], 0.5)
        self.assertFalse(hasattr(choice, "posterior"))
        with self.assertRaisesRegex(sysid.Error, "`choice` has no groups"):
            choice.groups()
        pathlib.Path("line.sysid").write_text(text + "forecast = predict choice on bench with draws(20), seed = 1\n")
        model = sysid.load("line.sysid")
        model.select(output="results", force=True)
        forecast = model.predict(output="results")
        for call in (forecast.groups, lambda: forecast.to_netcdf("none.nc")):
            with self.assertRaisesRegex(sysid.Error, "`forecast` has no groups: it is a prediction of a selection"):
                call()
        self.assertFalse(hasattr(forecast, "predictions"))
        self.assertFalse(pathlib.Path("none.nc").exists())
        self.assertIn("line.sysid", repr(sysid.load("line.sysid")))
        with self.assertRaisesRegex(sysid.Error, "no fit task"):
            sysid.load("line.sysid").log_density([1.0])

    def test_an_average_has_no_groups(self):
        text = DECAY.partition("forecast ")[0] + textwrap.dedent(
            """\
            other = fit decay to bench.train with mh(samples = 400, burn_in = 100, thin = 1, chains = 2), seed = 2
            both  = predict posterior, other on bench.test with draws(20), weights = equal, seed = 1
            """
        )
        pathlib.Path("decay.sysid").write_text(text)
        model = sysid.load("decay.sysid")
        for fit in ("posterior", "other"):
            model.fit(fit, output="results")
        both = model.predict(output="results")
        for call in (both.groups, lambda: both.to_netcdf("none.nc")):
            with self.assertRaisesRegex(sysid.Error, "`both` has no groups: it averages several fits"):
                call()
        with self.assertRaisesRegex(AttributeError, "averages several fits"):
            both.predictions

    def test_discover(self):
        text = """dictionary decaying {
  state y [m] = d
  target = y'
  terms = y, y^2, 1
}
data bench { file "bench.csv"; time t [s]; measure d = d [m] }
found = discover decaying from bench with spike_slab(derivatives = weak), seed = 1
"""
        pathlib.Path("terms.sysid").write_text(text)
        said = self.command_line("discover", "terms.sysid", "--quiet", "--no-figures")
        shutil.move("results", "of_command_line")
        found = sysid.load("terms.sysid").discover(output="results")
        self.assertEqual(found.text, said)
        self.assertEqual(files_of("results/found"), files_of("of_command_line/found"))


class Interrupt(Desk):
    def test_ctrl_c_keeps_draws_and_resume_goes_on(self):
        pathlib.Path("long.sysid").write_text(DECAY.replace("samples = 400", "samples = 100000"))
        program = textwrap.dedent(
            """
            import os, pathlib, signal, threading, time, sysid
            model = sysid.load("long.sysid")
            started = threading.Event()

            class Tell:
                def begin(self, what, total): self.what = what
                def expect(self, total): pass
                def advance(self, done, note):
                    if self.what == "sampling" and done > 200 and not started.is_set():
                        started.set()
                        os.kill(os.getpid(), signal.SIGINT)
                def end(self, finished): pass

            import sysid._progress
            sysid._progress.line_for = lambda wanted: Tell()
            fit = model.fit(output="results")
            print(fit.interrupted, fit.posterior.sizes["draw"] < 99900)
            again = model.fit(output="results", resume=True)
            print(again.interrupted, again.posterior.sizes["draw"])
            """
        )
        said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        self.assertEqual(said.stdout, "True True\nFalse 99900\n", said.stderr)
        whole = sysid.load("long.sysid").fit(output="whole")
        self.assertEqual(files_of("results/posterior")["draws_1.csv"], files_of(whole.folder)["draws_1.csv"])

    def test_a_density_is_given_up(self):
        program = textwrap.dedent(
            f"""
            import os, signal, threading, time, numpy, sysid
            model = sysid.load({str(ROOT / "models/duffing/duffing.sysid")!r})
            theta = model.sample_prior(400000, seed=1)
            threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
            try:
                for i in range(20):
                    model.log_density(theta)
                print("not heard")
            except KeyboardInterrupt:
                print("heard")
            try:
                time.sleep(0)
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(1)
            except KeyboardInterrupt:
                print("python's own again")
            """
        )
        said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        self.assertEqual(said.stdout, "heard\npython's own again\n", said.stderr)


if __name__ == "__main__":
    unittest.main()
