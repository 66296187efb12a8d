"""How models and results look in a notebook."""

import os
import pathlib
import re
import tempfile
import unittest
import xml.dom.minidom

import numpy as np

import sysid

ROOT = pathlib.Path(__file__).resolve().parents[2]


def well_formed(shown):
    """HTML without tags left open, which would spoil the notebook below it."""
    text = shown.replace("<br>", "<br/>").replace(" open>", ">")
    xml.dom.minidom.parseString(f"<div>{text}</div>".encode())
    return shown


class Display(unittest.TestCase):
    def setUp(self):
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(ROOT)

    def test_a_model(self):
        model = sysid.load("models/duffing/duffing.sysid")
        shown = well_formed(model._repr_html_())
        self.assertIn("Duffing&#x27;s oscillator", shown)
        self.assertIn("alttext=\"m*y'' + c*y' + k*y + k3*y^3 = x\"", shown)
        self.assertIn("<td style='text-align:left'>t, x, displacement</td>", shown)
        self.assertIn("<td style='text-align:left'>forecast</td>", shown)
        self.assertLess(shown.index("m*y'' + c"), shown.index("log_uniform"))
        self.assertIn(r"m \, \ddot{y} + c \, \dot{y} + k \, y + k_{3} \, {y}^{3} & = x", model._repr_latex_())

    def test_a_fit_and_its_figures(self):
        model = sysid.load("models/duffing/duffing.sysid")
        fit = model.fit()
        shown = well_formed(fit._repr_html_())
        self.assertIn("✓</b> the checks pass", shown)
        self.assertIn("<td>20.025</td><td>0.016</td><td>19.998 to 20.052</td>", shown)
        self.assertIn("<td>5.019e9</td><td>2.4e7</td><td>4.979e9 to 5.058e9</td>", shown)
        self.assertNotIn("figures/posterior.svg", fit.files)
        self.assertIn("posterior", fit.figures)
        figure = fit.figures["posterior"]
        xml.dom.minidom.parseString(figure.svg.encode())
        self.assertTrue(figure._repr_html_().startswith("<img alt='posterior' width='480' style='max-width:100%' src='data:image/svg+xml;base64,"))
        self.assertLess(len(figure.svg), 100_000)
        with self.assertRaisesRegex(KeyError, "no figure 'posterio'; there are .*posterior"):
            fit.figures["posterio"]
        with tempfile.TemporaryDirectory() as folder:
            figure.save(pathlib.Path(folder, "a.svg"))
            with self.assertRaisesRegex(ValueError, "as SVG, not as .png: name the file a.svg"):
                figure.save(pathlib.Path(folder, "a.png"))
            self.assertFalse(pathlib.Path(folder, "a.png").exists())
            self.assertEqual(pathlib.Path(folder, "a.svg").read_text(), figure.svg)
        forecast = well_formed(model.predict()._repr_html_())
        self.assertRegex(forecast, r"displacement on bench.test</td><td>0.00945</td>")
        self.assertIn("<td style='text-align:left'>posterior</td>", well_formed(sysid.compare(fit)._repr_html_()))
        self.assertIn("<td>0.091 to 0.58 %</td>", well_formed(model.check(seed=1)._repr_html_()))

    def test_an_optimum_with_warnings(self):
        model = sysid.load("models/duffing/duffing.sysid")
        text = model.text.replace("+ k3*y^3", "").replace("  parameter k3   [N/m^3] ~ log_uniform(5e8, 5e10)\n", "")
        text = text[: text.index("truth")] + "first = fit duffing to bench.train with map, seed = 1\n"
        fit = sysid.loads(text, "models/duffing").fit()
        shown = well_formed(fit._repr_html_())
        self.assertIn("!</b> use with care: 1 warning", shown)
        self.assertIn("<li>warning <code>residuals_not_white</code>", shown)
        self.assertIn("<th>optimum</th><th>sd</th></tr>", shown)
        self.assertRegex(shown, r"<td style='text-align:left'>N/m</td><td>11\d\d\d</td><td>\d\d</td></tr>")
        self.assertIn("<td>1 warning</td>", sysid.compare(fit)._repr_html_())

    def test_a_discovery(self):
        text = """dictionary decaying {
  state y [m] = d
  target = y'
  terms = y, y^2, 1
}
data bench { file "bench.csv"; time t [s]; measure d = d [m] }
found = discover decaying from bench with spike_slab(derivatives = weak), seed = 1
"""
        t = np.arange(100) * 0.05
        d = np.exp(-1.3 * t) + 0.002 * np.cos(23 * np.arange(100))
        shown = well_formed(sysid.loads(text, data={"t": t, "d": d}).discover()._repr_html_())
        self.assertIn("terms of y&#x27;", shown)
        self.assertRegex(shown, r"<code>y</code></td><td>-1.300\d*</td><td>[^<]*</td><td>1/s</td><td>1.000</td>")
        self.assertRegex(shown, r"<code>y\^2</code></td><td></td><td></td><td>1/\(m s\)</td><td>0.0\d+</td>")

    def test_a_selection(self):
        text = """model straight { input u\n parameter a ~ normal(0, sd = 5)\n observe d ~ normal(a*u, sd = 0.1) }
model bent { input u\n parameter a ~ normal(0, sd = 5)\n parameter b ~ normal(0, sd = 5)
  observe d ~ normal(a*u + b*u^2, sd = 0.1) }
model flat { input u\n parameter a ~ normal(0, sd = 5)\n observe d ~ normal(a + 0*u, sd = 0.1) }
data bench { file "line.csv"; input u = u; measure d = d }
candidates shapes { flat\n straight\n bent }
choice = select shapes to bench with reversible_jump, seed = 1
"""
        u = np.linspace(0, 1, 30)
        shown = well_formed(sysid.loads(text, data={"u": u, "d": 2 * u + 0.1 * np.cos(37 * u)}).select()._repr_html_())
        self.assertRegex(shown, r"<tbody><tr><td style='text-align:left'>straight</td><td>0.9\d*</td>")
        self.assertRegex(shown, r"<td style='text-align:left'>flat</td><td>&lt; 0.001</td>")

    def test_numbers_have_the_digits_that_are_known(self):
        from sysid._display import beside, significant

        given = [(19.99812, 0.0163), (5.01866e9, 0.024e9), (0.0, 1.0), (123456.7, 31.0), (2.1e-5, 1.1e-6), (-3.0, 40.0), (1.5, None)]
        expected = ["19.998", "5.019e9", "0.0", "123457", "2.10e-5", "-3", "1.5"]
        self.assertEqual([beside(*each) for each in given], expected)
        self.assertEqual(significant(2.4e7, 2), "2.4e7")
        self.assertEqual(significant(1.1e-6, 2), "1.1e-6")


class Words(unittest.TestCase):
    """Messages advise in Python's words."""

    def test_phrases(self):
        from sysid._words import in_python

        for said, expected in {
            "run the fit first: sysid run FILE, or sysid fit FILE": "run the fit first: model.fit()",
            "run the fit first: sysid run FILE -o a/b, or sysid fit FILE -o a/b": 'run the fit first: model.fit(output="a/b")',
            "run the fit again first: sysid fit FILE --force -o 'my results'":
                'run the fit again first: model.fit(force=True, output="my results")',
            "run the select again first: sysid select FILE --force": "run the select again first: model.select(force=True)",
            "finish it first: sysid fit FILE --resume": "finish it first: model.fit(resume=True)",
            "run it again: `sysid predict FILE --force`": "run it again: model.predict(force=True)",
            "add --force to replace them, or -o DIR to write elsewhere": "add force=True to replace them, or output=DIR to write elsewhere",
            "run the fit again, with --force or another -o": "run the fit again, with force=True or another output",
            "check priors and units with `sysid check`": "check priors and units with model.check()",
            "more: sysid explain E2103": 'more: sysid.explain("E2103")',
            "`sysid fit FILE --with-disturbance` adds": "`sysid fit FILE --with-disturbance` adds",  # which Python does not have
        }.items():
            self.assertEqual(in_python(said), expected)

    def test_phrases_of_cells(self):
        from sysid._words import in_cell

        for said, expected in {
            "add force=True to replace them, or output=DIR to write elsewhere": "add --force to replace them, or --output DIR to write elsewhere",
            "continue with resume=True, or start again with force=True": "start again with --force",
            "run it again: model.predict(force=True)": "run it again: model.predict(force=True)",
            "`k` is not declared": "`k` is not declared",
        }.items():
            self.assertEqual(in_cell(said), expected)

    def test_no_advice_for_a_shell_is_left(self):
        from sysid._words import in_python

        literal = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
        shell = re.compile(r"--(?:force|resume)\b|another -o\b|sysid (?:fit|predict|select|discover|check) FILE(?! --with)")
        found = 0
        for path in (ROOT / "src").rglob("*.cpp"):
            if path.relative_to(ROOT / "src").parts[0] in ("cli", "repl", "library"):
                continue
            for said in literal.findall(path.read_text()):
                text = re.sub(r"\{0?\}", "fit", said)
                if shell.search(text) and "prompt" not in text:
                    found += 1
                    self.assertNotRegex(in_python(text), shell, path)
        self.assertGreater(found, 10)


class Language(unittest.TestCase):
    TEXT = "model decay {\n  state y [m]\n  parameter rate [1/s] ~ log_\n  y' = -rate*y\n}\n"

    def test_completions(self):
        place = self.TEXT.index("log_") + 4
        begin, end, found = sysid.completions(self.TEXT, place)
        self.assertEqual(self.TEXT[begin:end], "log_")
        self.assertEqual({each.label for each in found}, {"log_uniform", "log_normal", "log_flat"})
        self.assertEqual(found[0].detail[:4], "log_")

    def test_positions_count_characters(self):
        text = "# Dämpfung ü\n" + self.TEXT
        begin, end, _ = sysid.completions(text, text.index("log_") + 4)
        self.assertEqual(text[begin:end], "log_")

    def test_hover(self):
        text = self.TEXT.replace("log_", "log_uniform(1, 2)")
        self.assertIn("[1/s]", sysid.hover(text, text.index("-rate") + 2))
        self.assertIsNone(sysid.hover(self.TEXT, 0))


if __name__ == "__main__":
    unittest.main()
