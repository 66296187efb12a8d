"""The model as a function: its values, its shapes, its errors, and what samplers and optimisers of other packages make of it."""

import os
import pathlib
import pickle
import tempfile
import threading
import unittest

import numpy as np

import sysid

ROOT = pathlib.Path(__file__).resolve().parents[2]
DUFFING = ROOT / "models/duffing/duffing.sysid"

LINE = """model line {
  input     u [V]
  parameter slope [m/V] ~ normal(0, sd = 10)
  parameter sd    [m] ~ log_uniform(0.01, 10)
  observe d ~ normal(slope*u, sd = sd)
}
data bench {
  file    "nowhere.csv"
  input   u = u [V]
  measure d = d [mm]
}
posterior = fit line to bench with mh, seed = 1
"""
CLOCK = """model decay {
  state y [mm]
  initial y = 1
  parameter k [1/s] ~ log_uniform(1e-4, 1)
  parameter sd [mm] ~ log_uniform(0.01, 1e4)
  y' = -k*y
  observe d ~ normal(y, sd = sd)
}
data bench {
  file    "nowhere.csv"
  RULES
  time    t
  measure d = d [mm]
}
posterior = fit decay to bench with map, seed = 1
"""
PURE = LINE.replace("slope [m/V]", "slope").replace("slope*u", "slope*(1 [m/V])*u")
U = np.linspace(-1, 1, 20)
D = 1e3 * (2 * U + 0.1 * np.cos(37 * U))  # [mm]


def log_normal(x, mean, sd):
    return -0.5 * np.log(2 * np.pi) - np.log(sd) - 0.5 * ((x - mean) / sd) ** 2


class Closed(unittest.TestCase):
    """A straight line, whose density is known."""

    def setUp(self):
        self.model = sysid.loads(LINE, data={"u": U, "d": D})

    def test_parameters(self):
        self.assertEqual(self.model.names, ["slope", "sd"])
        self.assertEqual(self.model.units, ["m/V", "m"])
        self.assertEqual(self.model.dimension, 2)
        slope, sd = self.model.parameters
        self.assertEqual(sd.prior, "log_uniform(0.01, 10)")
        self.assertEqual((sd.lower, sd.upper), (0.01, 10))
        self.assertEqual((slope.lower, slope.upper), (-np.inf, np.inf))
        self.assertEqual(self.model.tasks, [("posterior", "fit")])

    def expected(self, slope, sd, jacobian):
        # Samples have the unit of the model here, [mm] as the data block binds the column without a unit of the channel.
        scale = self.scale
        likelihood = log_normal(D * scale, slope * U, sd).sum()
        prior = log_normal(slope, 0, 10) - np.log(sd) - np.log(np.log(10 / 0.01))
        share = np.log(sd / 0.01) / np.log(10 / 0.01)
        return likelihood, prior, np.log(sd * share * (1 - share) * np.log(10 / 0.01)) if jacobian else 0.0

    def test_values(self):
        values = np.array([[2.0, 0.1], [1.5, 0.3], [-3.0, 5.0]])
        self.scale = 1e-3
        likelihood = self.model.log_density(values, declared=True, part="likelihood")
        prior = self.model.log_density(values, declared=True, part="prior")
        for w, (slope, sd) in enumerate(values):
            of_data, of_prior, _ = self.expected(slope, sd, False)
            self.assertAlmostEqual(prior[w], of_prior, places=10)
            # All constants are kept; densities are per declared unit of the sample, so they differ by one constant.
            self.assertAlmostEqual(likelihood[w] - likelihood[0], of_data - self.expected(*values[0], False)[0], places=8)
        np.testing.assert_allclose(self.model.log_density(values, declared=True), likelihood + prior, rtol=1e-14)

    def test_constrain_and_back(self):
        theta = np.random.default_rng(1).normal(size=(50, 2))
        values = self.model.constrain(theta)
        self.assertTrue(np.all((values[:, 1] > 0.01) & (values[:, 1] < 10)))
        np.testing.assert_allclose(self.model.unconstrain(values), theta, rtol=1e-9, atol=1e-9)
        # The density on R^P is that of the values times the Jacobian.
        step = 1e-6
        jacobian = (self.model.constrain(theta + [0, step])[:, 1] - self.model.constrain(theta - [0, step])[:, 1]) / (2 * step)
        difference = self.model.log_density(theta) - self.model.log_density(values, declared=True)
        np.testing.assert_allclose(difference, np.log(jacobian), atol=1e-6)

    def test_outside_the_support(self):
        density = self.model.log_density([[2.0, 0.1], [2.0, 20.0], [2.0, -1.0], [np.nan, 0.1]], declared=True)
        self.assertTrue(np.isfinite(density[0]))
        self.assertEqual(list(density[1:]), [-np.inf] * 3)

    def test_at_the_edge_of_a_closed_support(self):
        at, within = self.model.log_density([[2.0, 0.01], [2.0, 0.01 * (1 + 1e-9)]], declared=True)
        self.assertAlmostEqual(at / within, 1, places=6)
        at, within = self.model.log_density([[2.0, 10.0], [2.0, 10 * (1 - 1e-9)]], declared=True)
        self.assertAlmostEqual(at / within, 1, places=6)
        priors = {
            "uniform(-1, 2)": [(-1.0, -np.log(3)), (2.0, -np.log(3)), (2.1, -np.inf)],
            "half_normal(sd = 1)": [(0.0, np.log(2) + log_normal(0, 0, 1)), (-1e-9, -np.inf)],
            "exponential(rate = 2)": [(0.0, np.log(2))],
            "gamma(shape = 2, rate = 1)": [(0.0, -np.inf)],  # the density is 0 there
            "log_normal(median = 1, log_sd = 0.5)": [(0.0, -np.inf)],
            "gamma(shape = 0.5, rate = 3)": [(0.0, np.inf), (-1e-9, -np.inf)],
            "beta(2, 3)": [(0.0, -np.inf), (1.0, -np.inf)],
            "beta(0.5, 0.5)": [(0.0, np.inf), (1.0, np.inf)],
            "beta(1, 3)": [(0.0, np.log(3)), (1.0, -np.inf)],
            "beta(3, 1)": [(0.0, -np.inf), (1.0, np.log(3))],
            "beta(1e5, 1)": [(1.0, np.log(1e5))],
            "beta(1, 1)": [(0.0, 0.0), (1.0, 0.0)],
            "uniform(0, 1)": [(0.0, 0.0), (1.0, 0.0), (np.inf, -np.inf)],
        }
        for prior, expected in priors.items():
            text = PURE if "beta" in prior else LINE
            model = sysid.loads(text.replace("normal(0, sd = 10)", prior), data={"u": U, "d": D})
            values = [[value, 0.1] for value, _ in expected]
            density = model.log_density(values, declared=True, part="prior")
            other = -np.log(0.1) - np.log(np.log(1000))  # of sd
            for (value, density_of_prior), found in zip(expected, density):
                with self.subTest(prior=prior, value=value):
                    if np.isfinite(density_of_prior):
                        self.assertAlmostEqual(found, density_of_prior + other, places=6)
                    else:
                        self.assertEqual(found, density_of_prior)

    def test_a_density_without_bound_is_still_zero_where_another_factor_is(self):
        text = PURE.replace("normal(0, sd = 10)", "beta(0.5, 0.5)").replace("~ log_uniform(0.01, 10)", "~ gamma(shape = 2, rate = 1)")
        model = sysid.loads(text, data={"u": U, "d": D})
        values = [[0.0, 0.5], [0.0, 0.0], [0.5, 0.0], [0.0, -1.0]]
        self.assertEqual(list(model.log_density(values, declared=True, part="prior")), [np.inf, -np.inf, -np.inf, -np.inf])
        self.assertEqual(model.log_density(values[0], declared=True), np.inf)
        self.assertTrue(np.isfinite(model.log_density(values[0], declared=True, part="likelihood")))

    def test_no_gradient_where_a_coordinate_is_not_finite(self):
        theta = np.array([[np.nan, 0.0], [0.5, 0.0], [np.inf, 0.0]])
        value, gradient = self.model.log_density_and_gradient(theta)
        self.assertEqual([value[0], value[2]], [-np.inf, -np.inf])
        self.assertTrue(np.isnan(gradient[[0, 2]]).all() and np.isfinite(gradient[1]).all())
        residuals, jacobian = self.model.residuals_and_jacobian(theta)
        self.assertTrue(np.isnan(jacobian[[0, 2]]).all() and np.isfinite(jacobian[1]).all())
        self.assertFalse(np.isfinite(residuals[[0, 2]]).all(axis=1).any())

    def test_empty_batches(self):
        model, none = self.model, np.zeros((0, 2))
        self.assertEqual(model.log_density(none).shape, (0,))
        self.assertEqual(model.log_density(none, declared=True).shape, (0,))
        self.assertEqual(model.gradient(none).shape, (0, 2))
        self.assertEqual([each.shape for each in model.log_density_and_gradient(none)], [(0,), (0, 2)])
        self.assertEqual(model.residuals(none).shape, (0, 21))
        self.assertEqual([each.shape for each in model.residuals_and_jacobian(none)], [(0, 21), (0, 21, 2)])
        self.assertEqual(model.constrain(none).shape, (0, 2))
        self.assertEqual(model.unconstrain(none).shape, (0, 2))
        self.assertEqual(model.simulate(none).values["d"].shape, (0, 20))
        self.assertEqual(model.simulate(none).noisy["d"].shape, (0, 20))
        with self.assertRaisesRegex(ValueError, r"\[W x 2\]"):
            model.log_density(np.zeros((0, 3)))

    def test_gradient(self):
        theta = np.random.default_rng(2).normal(size=(20, 2))
        value, gradient = self.model.log_density_and_gradient(theta)
        np.testing.assert_allclose(value, self.model.log_density(theta), rtol=1e-10)
        np.testing.assert_array_equal(gradient, self.model.gradient(theta))
        for p in range(2):
            step = 1e-5 * np.eye(2)[p]
            slope = (self.model.log_density(theta + step) - self.model.log_density(theta - step)) / 2e-5
            np.testing.assert_allclose(gradient[:, p], slope, rtol=1e-5, atol=1e-4)

    def test_residuals(self):
        theta = np.random.default_rng(3).normal(size=(10, 2))
        residuals = self.model.residuals(theta)
        self.assertEqual(residuals.shape, (10, self.model.residual_count))
        self.assertEqual(self.model.residual_count, len(U) + 1)
        constant = self.model.log_density(theta, part="likelihood") + 0.5 * (residuals**2).sum(axis=1)
        np.testing.assert_allclose(constant, constant[0], rtol=1e-10)
        again, jacobian = self.model.residuals_and_jacobian(theta)
        np.testing.assert_array_equal(again, residuals)
        self.assertEqual(jacobian.shape, (10, len(U) + 1, 2))
        step = np.array([1e-5, 0])
        slope = (self.model.residuals(theta + step) - self.model.residuals(theta - step)) / 2e-5
        np.testing.assert_allclose(jacobian[:, :, 0], slope, rtol=1e-4, atol=1e-4)

    def test_simulate(self):
        made = self.model.simulate([[2.0, 0.1], [3.0, 0.1]])
        self.assertEqual(made.experiment, "bench")
        np.testing.assert_allclose(made.values["d"][1] / made.values["d"][0], np.full(20, 1.5))
        self.assertEqual(made.noisy["d"].shape, (2, 20))
        self.assertFalse(np.array_equal(made.noisy["d"], self.model.simulate([[2.0, 0.1], [3.0, 0.1]], seed=1).noisy["d"]))
        self.assertEqual(self.model.simulate([2.0, 0.1]).values["d"].shape, (20,))

    def test_an_experiment_has_a_name_and_a_number(self):
        by_number = self.model.simulate([2.0, 0.1], 0).values["d"]
        for experiment in ("bench", np.int64(0)):
            np.testing.assert_array_equal(self.model.simulate([2.0, 0.1], experiment).values["d"], by_number)
        with self.assertRaisesRegex(KeyError, "'hall' does not name exactly one experiment of the fit; it has 0: 'bench'"):
            self.model.simulate([2.0, 0.1], "hall")
        with self.assertRaisesRegex(IndexError, "no experiment 1; it has 0: 'bench'"):
            self.model.simulate([2.0, 0.1], 1)
        with self.assertRaisesRegex(TypeError, "a name or a number, not 0.5"):
            self.model.simulate([2.0, 0.1], 0.5)
        part = sysid.loads(LINE.replace("[mm]\n}", "[mm]\n  split   train = rows 1..15\n}").replace("to bench", "to bench.train"), data={"u": U, "d": D})
        self.assertEqual(part.simulate([2.0, 0.1], "bench.train").experiment, "bench.train")
        self.assertEqual(part.simulate([2.0, 0.1], "bench").experiment, "bench.train")

    def test_texts_and_columns_that_are_none(self):
        with self.assertRaisesRegex(ValueError, "has an invalid character"):
            sysid.loads("model q {\ud800}")
        with self.assertRaisesRegex(TypeError, "is a str, not bytes"):
            sysid.loads(b"model")
        with self.assertRaisesRegex(ValueError, "column `u` of the data for `bench` holds a number beyond"):
            sysid.loads(LINE, data={"u": [10**400] * 20, "d": D})

    def test_one_vector(self):
        theta = np.array([0.3, -0.2])
        self.assertIsInstance(self.model.log_density(theta), float)
        self.assertEqual(self.model.log_density(theta), self.model.log_density(theta[np.newaxis])[0])
        self.assertEqual(self.model.gradient(theta).shape, (2,))
        self.assertEqual(self.model.constrain(theta).shape, (2,))
        self.assertEqual(self.model.residuals(theta).shape, (21,))
        with self.assertRaisesRegex(ValueError, "vector of 2 parameters"):
            self.model.log_density([1.0, 2.0, 3.0])
        with self.assertRaisesRegex(ValueError, r"shape \(W, 2\)"):
            self.model.log_density(np.zeros((2, 3)))

    def test_prior_draws(self):
        draws = self.model.sample_prior(4000, seed=3)
        np.testing.assert_array_equal(draws, self.model.sample_prior(4000, seed=3))
        values = self.model.constrain(draws)
        self.assertAlmostEqual(values[:, 0].std(), 10, delta=0.5)
        self.assertAlmostEqual(np.log10(values[:, 1]).mean(), -0.5, delta=0.1)

    def test_pickle(self):
        again = pickle.loads(pickle.dumps(self.model))
        theta = np.zeros((3, 2))
        np.testing.assert_array_equal(again.log_density(theta), self.model.log_density(theta))

    def test_display(self):
        self.assertIn("slope [m/V] ~ normal(0, sd = 10)", repr(self.model))
        self.assertIn('alttext="parameter sd [m] ~ log_uniform(0.01, 10)"', self.model._repr_html_())


class Data(unittest.TestCase):
    """Tables, mappings and frames give the same numbers."""

    def test_the_same_from_a_file_a_mapping_a_frame_and_a_data_set(self):
        import pandas
        import xarray

        table = pandas.read_csv(DUFFING.parent / "duffing_1pct.csv", comment="#", float_precision="round_trip")
        columns = {name: table[name].to_numpy() for name in table.columns}
        theta = np.tile(sysid.load(DUFFING).sample_prior(1, seed=5), (3, 1))
        expected = sysid.load(DUFFING).log_density(theta)
        self.assertTrue(np.all(np.isfinite(expected)))
        given = [
            columns,
            {"bench": columns},
            pandas.DataFrame(columns),
            {"bench": pandas.DataFrame(columns)},
            xarray.Dataset({name: ("row", values) for name, values in columns.items()}),
        ]
        for data in given:
            np.testing.assert_array_equal(sysid.load(DUFFING, data=data).log_density(theta), expected)

    def test_missing_samples(self):
        holes = D.copy()
        holes[3] = np.nan
        whole, rest = (sysid.loads(LINE, data={"u": U, "d": each}) for each in (D, holes))
        self.assertEqual(rest.residual_count, whole.residual_count - 1)

    def test_columns_with_masks_and_missing_values(self):
        import pandas

        holes = D.copy()
        holes[3] = np.nan
        expected = sysid.loads(LINE, data={"u": U, "d": holes}).log_density(np.zeros(2))
        absent = np.arange(20) == 3
        given = [
            {"u": U, "d": np.ma.masked_array(D, mask=absent)},
            {"u": U, "d": [None if gone else float(each) for each, gone in zip(D, absent)]},
            pandas.DataFrame({"u": U, "d": pandas.array(np.where(absent, None, D), dtype="Float64")}),
        ]
        for data in given:
            model = sysid.loads(LINE, data=data)
            self.assertEqual(model.residual_count, 20)
            self.assertEqual(model.log_density(np.zeros(2)), expected)

    def test_arrays_are_no_file(self):
        """How the file is written that they replace says nothing of them, nor do names and rows that a table would need."""
        expected = sysid.loads(LINE, data={"u": U, "d": D}).log_density(np.zeros(2))
        for rules in (
            'decimal = ",", thousands = "."',
            "values = 4",
            "missing = 0",
            'separator = ";"',
            "encoding = utf16",
            "names = 3",
            "units = 2",  # the columns have theirs in the block
        ):
            with self.subTest(rules=rules):
                text = LINE.replace('"nowhere.csv"\n', f'"nowhere.csv"\n  read    {rules}\n')
                self.assertEqual(sysid.loads(text, data={"u": U, "d": D}).log_density(np.zeros(2)), expected)
        for name in ("X[:, 2]", "u;;;", "#u", "u, V"):
            with self.subTest(name=name):
                text = LINE.replace("u = u [V]", f'u = "{name}" [V]')
                self.assertEqual(sysid.loads(text, data={name: U, "d": D}).log_density(np.zeros(2)), expected)

    def test_a_block_whose_data_are_arrays_needs_no_file_line(self):
        arrays = {"u": U, "d": D}
        text = LINE.replace('  file    "nowhere.csv"\n', "")
        self.assertNotIn("nowhere", text)
        model = sysid.loads(text, data=arrays)
        expected = sysid.loads(LINE, data=arrays).log_density(np.zeros(2))
        self.assertEqual(model.log_density(np.zeros(2)), expected)
        self.assertEqual(pickle.loads(pickle.dumps(model)).log_density(np.zeros(2)), expected)
        with self.assertRaisesRegex(sysid.Error, r"error\[E4101\]: data block `\w+` names no file"):
            sysid.loads(text)
        with self.assertRaisesRegex(sysid.Error, r"E4113|E2"):  # what else is wrong with the block is found as in one with a file
            sysid.loads(text.replace("u = u [V]", "u = u [kg]"), data=arrays)

    def test_what_numbers_mean_holds_for_arrays(self):
        """Marks of missing samples, and what times count since a date, are rules of the block, and the lines of messages work."""

        def load(rules, d=D, time=None):
            text = LINE.replace('"nowhere.csv"\n', f'"nowhere.csv"\n  read    {rules}\n' if rules else '"nowhere.csv"\n')
            data = {"u": U, "d": d}
            if time is not None:
                text, data = CLOCK.replace("RULES", f"read {rules}" if rules else ""), {"t": time, "d": d}
            return sysid.loads(text, data=data)

        theta = np.zeros(2)
        holes, marks, real = (np.where(np.arange(20) == 5, mark, D) for mark in (np.nan, -777.5, -9999.0))
        expected = load("", holes).log_density(theta)
        self.assertEqual(load('missing = "-777.5"', marks).log_density(theta), expected)
        self.assertEqual(load('missing = "-777,5", decimal = ","', marks).log_density(theta), expected)  # as the file writes it
        self.assertNotEqual(load("", marks).log_density(theta), expected)
        with self.assertRaisesRegex(sysid.Error, "E4022"):
            load("", real).log_density(theta)
        self.assertEqual(load('missing = "-9999"', real).log_density(theta), expected)
        self.assertTrue(np.isfinite(load("missing = none", real).log_density(theta)))
        seconds = 60.0 * np.arange(20)
        expected = load("", time=seconds).log_density(theta)
        for start, scale, word in ((1714500000, 1, "seconds"), (1714500000000, 1e3, "milliseconds"), (45356.5, 1 / 86400, "days")):
            times = start + seconds * scale
            with self.subTest(word=word):
                with self.assertRaisesRegex(sysid.Error, f"E4029(.|\n)*`read stamp = {word}`"):
                    load("", time=times).log_density(theta)
                np.testing.assert_allclose(load(f"stamp = {word}", time=times).log_density(theta), expected, rtol=1e-9)

    def test_what_only_the_file_states_is_asked_for(self):
        seconds = 60.0 * np.arange(20)
        text = CLOCK.replace("RULES", "read stamp = iso")
        with self.assertRaisesRegex(sysid.Error, r"E4025(.|\n)*`time t \[s\]`"):
            sysid.loads(text, data={"t": seconds, "d": D})
        stated = sysid.loads(text.replace("time    t", "time    t [s]"), data={"t": seconds, "d": D})
        plain = sysid.loads(CLOCK.replace("RULES", ""), data={"t": seconds, "d": D})
        self.assertEqual(stated.log_density(np.zeros(2)), plain.log_density(np.zeros(2)))
        bare = LINE.replace("u = u [V]", "u = u").replace('"nowhere.csv"\n', '"nowhere.csv"\n  read    units = names\n')
        with self.assertRaisesRegex(sysid.Error, "E4025(.|\n)*column `u`"):
            sysid.loads(bare, data={"u": U, "d": D})
        stated = sysid.loads(bare.replace("u = u", "u = u [V]"), data={"u": U, "d": D})
        self.assertEqual(stated.log_density(np.zeros(2)), sysid.loads(LINE, data={"u": U, "d": D}).log_density(np.zeros(2)))

    def test_rows_that_are_missing_at_the_end_are_rows(self):
        text = """model decay {
  parameter a ~ normal(0, sd = 1)
  state z
  z' = -a*z/(1 [s])
  initial z = 1
  observe z ~ normal(z, sd = 0.1)
}
data bench {
  file    "nowhere.csv"
  rate    1 [Hz]
  measure z = z
}
posterior = fit decay to bench with mh, seed = 1
"""
        made = sysid.loads(text, data={"z": [1, 0.4, np.nan, np.nan]}).simulate([0.5], seed=1)
        self.assertEqual(len(made["time"] if isinstance(made, dict) else made.time), 4)

    def test_columns_of_a_frame_that_are_numbered_are_found_by_their_numbers(self):
        import pandas

        expected = sysid.loads(LINE, data={"u": U, "d": D}).log_density(np.zeros(2))
        text = LINE.replace("u = u [V]", 'u = "0" [V]').replace("d = d [mm]", 'd = "1" [mm]')
        for data in (pandas.DataFrame(np.column_stack([U, D])), {0: U, 1: D}, {"0": U, "1": D}):
            self.assertEqual(sysid.loads(text, data=data).log_density(np.zeros(2)), expected)

    def test_the_index_of_a_frame_is_a_column(self):
        import pandas

        expected = sysid.loads(LINE, data={"u": U, "d": D}).log_density(np.zeros(2))
        frame = pandas.DataFrame({"u": U, "d": D})
        levels = frame.assign(run=1)
        for data in (frame.set_index("u"), frame.set_index("d"), levels.set_index(["run", "u"])):
            self.assertEqual(sysid.loads(LINE, data=data).log_density(np.zeros(2)), expected)
        with self.assertRaisesRegex(sysid.Error, "no column `u`"):
            sysid.loads(LINE, data=frame.set_index("u").rename_axis(None))
        dates = pandas.date_range("2024-01-01", periods=20, freq="s")
        for column in (dates, dates.tz_localize("CET")):
            with self.assertRaisesRegex(TypeError, "subtract the first, then divide by the unit"):
                sysid.loads(LINE, data=pandas.DataFrame({"d": D}, index=pandas.Index(column, name="u")))

    def test_frames_of_parameters_are_taken_by_name(self):
        import pandas

        model = sysid.loads(LINE, data={"u": U, "d": D})
        values = np.array([[2.0, 0.1], [1.5, 0.3]])
        expected = model.log_density(values, declared=True)
        frame = pandas.DataFrame(values, columns=model.names)
        for given in (frame, frame[["sd", "slope"]], pandas.DataFrame(values)):
            np.testing.assert_array_equal(model.log_density(given, declared=True), expected)
        self.assertEqual(model.log_density(frame[["sd", "slope"]].iloc[1], declared=True), expected[1])
        with self.assertRaisesRegex(ValueError, "expected the parameters slope, sd, not slope, scale"):
            model.log_density(frame.rename(columns={"sd": "scale"}), declared=True)

    def test_masked_parameters_have_no_density(self):
        theta = np.ma.masked_array(np.zeros((2, 2)), mask=[[False, True], [False, False]])
        density = sysid.loads(LINE, data={"u": U, "d": D}).log_density(theta)
        self.assertEqual(density[0], -np.inf)
        self.assertTrue(np.isfinite(density[1]))

    def test_numbers_that_would_lose_what_they_say(self):
        for column in (D + 1j, D.astype("timedelta64[ms]"), D.astype("datetime64[ms]"), D.astype(complex).astype(object)):
            with self.assertRaisesRegex(TypeError, "column `d` of the data for `bench` holds .*, not numbers"):
                sysid.loads(LINE, data={"u": U, "d": column})
        with self.assertRaisesRegex(TypeError, "real numbers, not complex128"):
            sysid.loads(LINE, data={"u": U, "d": D}).log_density(np.zeros(2) + 0j)
        with self.assertRaisesRegex(TypeError, "mapping from names to columns.*not ndarray"):
            sysid.loads(LINE, data=np.zeros((20, 2)))

    def test_a_pickle_is_of_what_was_loaded(self):
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        theta = np.ones((3, 2))
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            pathlib.Path("line.sysid").write_text(LINE)
            columns = {"u": U.copy(), "d": D.copy()}
            model = sysid.load("line.sysid", data=columns)
            expected = model.log_density(theta)
            columns["d"][:] = 0
            pathlib.Path("line.sysid").write_text(LINE.replace("sd = 10)", "sd = 1)"))
            np.testing.assert_array_equal(pickle.loads(pickle.dumps(model)).log_density(theta), expected)
            kept = pickle.dumps(model)
            pathlib.Path("nowhere.csv").write_text("u,d\n" + "".join(f"{u!r},{d!r}\n" for u, d in zip(U.tolist(), D.tolist())))
            of_files = sysid.load("line.sysid")
            files, expected_of_files = pickle.dumps(of_files), of_files.log_density(theta)
            os.mkdir("inner")
            os.chdir("inner")
            np.testing.assert_array_equal(pickle.loads(kept).log_density(theta), expected)
            np.testing.assert_array_equal(pickle.loads(files).log_density(theta), expected_of_files)
            os.chdir(before)

    def test_another_working_directory_leads_to_no_other_record(self):
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        theta = np.ones(2)
        with tempfile.TemporaryDirectory() as folder:
            for name, scale in (("a", 1.0), ("b", 2.0)):
                os.mkdir(os.path.join(folder, name))
                rows = "".join(f"{u!r},{scale * d!r}\n" for u, d in zip(U.tolist(), D.tolist()))
                pathlib.Path(folder, name, "nowhere.csv").write_text("u,d\n" + rows)
            os.chdir(os.path.join(folder, "a"))
            pathlib.Path("line.sysid").write_text(LINE)
            expected = sysid.load("line.sysid").log_density(theta)
            models = [sysid.load("line.sysid"), sysid.loads(LINE), sysid.loads(LINE, data={"u": U, "d": D})]
            self.assertEqual(models[0].path, "line.sysid")
            for other in ("../b", ".."):
                os.chdir(other)
                for model in models:
                    self.assertEqual(model.log_density(theta), expected)
                    self.assertEqual(pickle.loads(pickle.dumps(model)).log_density(theta), expected)
            self.assertEqual(models[0].path, os.path.join(os.path.realpath(folder), "a", "line.sysid"))
            os.chdir(before)

    def test_a_comment_in_another_encoding(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "line.sysid")
            path.write_bytes(LINE.encode() + b"# in \xb5m\n")
            model = sysid.load(path, data={"u": U, "d": D})
            self.assertTrue(model.text.endswith("# in \N{REPLACEMENT CHARACTER}m\n"))
            again = pickle.loads(pickle.dumps(model))
            self.assertEqual(again.log_density(np.ones(2)), model.log_density(np.ones(2)))
            path.write_bytes(LINE.encode().replace(b"slope*u, sd = sd)", b"slop*u, sd = sd)  # \xb5"))
            with self.assertRaises(sysid.Error) as caught:
                sysid.load(path)
            self.assertEqual(caught.exception.code, "E2001")
            self.assertEqual(caught.exception.diagnostics[0]["code"], "E2001")
            path.write_bytes(LINE.encode().replace(b"slope*u", b"slope*u\xb5"))
            with self.assertRaisesRegex(sysid.Error, "the byte 0xb5 is not valid UTF-8"):
                sysid.load(path)

    def test_what_is_wrong_with_data(self):
        with self.assertRaisesRegex(sysid.Error, "no column `d`.*\n.*reads `u`, `d`; there are `u`"):
            sysid.loads(LINE, data={"u": U})
        with self.assertRaisesRegex(sysid.Error, "no data block `hall`"):
            sysid.loads(LINE, data={"hall": {"u": U, "d": D}})
        with self.assertRaisesRegex(ValueError, "differ in length"):
            sysid.loads(LINE, data={"u": U, "d": D[1:]})
        with self.assertRaisesRegex(TypeError, "not numbers"):
            sysid.loads(LINE, data={"u": U, "d": np.array(["a"] * 20)})


class Errors(unittest.TestCase):
    def test_located(self):
        with self.assertRaises(sysid.Error) as caught:
            sysid.loads(LINE.replace("slope*u", "slop*u"), folder="there")
        error = caught.exception
        self.assertTrue(str(error).startswith("there/text.sysid:5:"), str(error))
        self.assertIn("did you mean `slope`?", str(error))
        self.assertEqual(error.code, "E2001")
        self.assertEqual(error.line, 5)
        self.assertEqual(error.help, "did you mean `slope`?")
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.code), (str(error), "E2001"))

    def test_files(self):
        with self.assertRaisesRegex(sysid.Error, "cannot read `nowhere.sysid`"):
            sysid.load("nowhere.sysid")
        with self.assertRaises(sysid.Error) as caught:
            sysid.loads(LINE).log_density([0, 0])
        self.assertEqual(caught.exception.line, 8)
        with self.assertRaisesRegex(sysid.Error, "`forecast` is not a fit task"):
            sysid.load(DUFFING, task="forecast").log_density(np.zeros(5))
        with self.assertRaisesRegex(sysid.Error, "no fit task"):
            sysid.loads(LINE[: LINE.index("posterior")], data={"u": U, "d": D}).dimension

    def test_failures_are_counted_where_they_happen(self):
        text = """model growth {
  state y
  initial y = 1
  parameter rate ~ normal(0, sd = 1000)
  y' = rate*y^3 * 1 [1/s]
  observe d ~ normal(y, sd = 0.1)
}
data bench {
  file    "nowhere.csv"
  time    t [s]
  measure d = d
}
posterior = fit growth to bench with mh, seed = 1
"""
        model = sysid.loads(text, data={"t": np.arange(20.0), "d": np.ones(20)})
        density = model.log_density([[-1.0], [500.0], [600.0]], declared=True)
        self.assertTrue(np.isfinite(density[0]))
        self.assertEqual(list(density[1:]), [-np.inf, -np.inf])
        self.assertEqual(sum(each["count"] for each in model.failures), 2)
        self.assertIn("`y^3` (./text.sysid:5:", model.failures[0]["where"])
        self.assertTrue(np.isnan(model.gradient(model.unconstrain([[500.0]]))).all())
        residuals, jacobian = model.residuals_and_jacobian(model.unconstrain([[-1.0], [500.0]]))
        self.assertTrue(np.isfinite(residuals[0]).all() and np.isfinite(jacobian[0]).all())
        self.assertTrue(np.isinf(residuals[1]).all() and np.isnan(jacobian[1]).all())
        # An optimiser does not report success there.
        import scipy.optimize

        def negative(theta):
            value, gradient = model.log_density_and_gradient(theta)
            return -value, -gradient

        with np.errstate(all="ignore"):
            found = scipy.optimize.minimize(negative, model.unconstrain([500.0]), jac=True, method="BFGS")
        self.assertFalse(found.success)
        self.assertTrue(np.all(np.isinf(model.residuals(model.unconstrain([500.0])))))
        self.assertTrue(np.all(np.isnan(model.simulate([500.0]).values["y"])))


class Running(unittest.TestCase):
    def test_a_thread_that_prepares_beside_others(self):
        model = sysid.load(DUFFING, threads=1)
        theta = model.sample_prior(8, seed=2)
        ended = threading.Event()
        wrong = []

        def compute():
            while not ended.is_set():
                if model.log_density(theta).shape != (8,):
                    wrong.append("shape")

        workers = [threading.Thread(target=compute) for _ in range(2)]
        for worker in workers:
            worker.start()
        for seed in (1, 2):
            model.prepare(seed=seed)
        ended.set()
        for worker in workers:
            worker.join()
        self.assertEqual(wrong, [])
        np.testing.assert_array_equal(model.log_density(theta), model.log_density(theta))

    def test_threads_and_forks(self):
        model = sysid.load(DUFFING)
        theta = model.sample_prior(64, seed=2)
        expected = model.log_density(theta)
        np.testing.assert_array_equal(sysid.load(DUFFING, threads=1).log_density(theta), expected)
        found = [None] * 4
        workers = [threading.Thread(target=lambda i=i: found.__setitem__(i, model.log_density(theta))) for i in range(4)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        for each in found:
            np.testing.assert_array_equal(each, expected)
        read, write = os.pipe()
        if os.fork() == 0:
            try:
                os.write(write, model.log_density(theta).tobytes())
            finally:
                os._exit(0)
        os.close(write)
        with os.fdopen(read, "rb") as pipe:
            self.assertEqual(pipe.read(), expected.tobytes())
        os.wait()


if __name__ == "__main__":
    unittest.main()
