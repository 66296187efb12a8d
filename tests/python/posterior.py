"""Samplers and optimisers of other packages on the Duffing density find the posterior of `sysid fit`."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

import sysid

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "models/duffing"


class Posterior(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("duffing.sysid", "duffing_1pct.csv"):
                shutil.copy(FOLDER / name, folder)
            command = [os.environ["SYSID_PROGRAM"], "fit", "duffing.sysid", "--quiet", "--no-figures"]
            subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
            summary = json.loads((pathlib.Path(folder) / "results/posterior/summary.json").read_text())
        cls.model = sysid.load(FOLDER / "duffing.sysid").prepare(seed=1)
        of_name = summary["parameters"]
        cls.mean = np.array([of_name[name]["mean"] for name in cls.model.names])
        cls.sd = np.array([of_name[name]["sd"] for name in cls.model.names])
        cls.modes = summary["modes"]

    def assertPosterior(self, mean):
        distance = np.abs(mean - self.mean) / self.sd
        self.assertLess(distance.max(), 0.1, dict(zip(self.model.names, distance)))

    def test_the_mode_is_that_of_the_fit_to_the_bit(self):
        mode = self.model.modes[0]
        self.assertEqual(mode.log_density, self.modes[0]["log_density"])
        self.assertEqual(self.model.log_density(mode.theta), mode.log_density)

    def test_emcee(self):
        import emcee

        mode = self.model.modes[0]
        start = np.random.default_rng(1).multivariate_normal(mode.theta, mode.covariance, size=64)
        sampler = emcee.EnsembleSampler(64, self.model.dimension, self.model.log_density, vectorize=True)
        sampler.random_state = np.random.RandomState(1).get_state()
        sampler.run_mcmc(start, 3000)
        draws = self.model.constrain(sampler.get_chain(discard=500, flat=True))
        self.assertPosterior(draws.mean(axis=0))
        np.testing.assert_allclose(draws.std(axis=0), self.sd, rtol=0.1)

    def test_optimisers_of_scipy(self):
        from scipy import optimize, stats

        start = self.model.unconstrain([1.2, 25.0, 9e3, 4e9, 1e10])

        def negative(theta):
            value, gradient = self.model.log_density_and_gradient(theta)
            return -value, -gradient

        found = optimize.minimize(negative, start, jac=True, method="BFGS").x
        # The mode of all parameters is not the mean of each: draws of the normal distribution about it are weighed by the density.
        steps = 1e-4 * np.eye(len(found))
        hessian = (self.model.gradient(found - steps) - self.model.gradient(found + steps)) / 2e-4
        covariance = np.linalg.inv((hessian + hessian.T) / 2)
        proposal = stats.multivariate_t(found, covariance, df=8, seed=1)
        theta = proposal.rvs(20000)
        weights = self.model.log_density(theta) - proposal.logpdf(theta)
        weights = np.exp(weights - weights.max())
        self.assertGreater(weights.sum() ** 2 / (weights**2).sum(), 10000)
        self.assertPosterior(weights @ self.model.constrain(theta) / weights.sum())
        # Residuals leave the prior out, which these data outweigh.
        squares = optimize.least_squares(
            self.model.residuals, start, jac=lambda theta: self.model.residuals_and_jacobian(theta)[1], x_scale="jac"
        )
        distance = np.abs(self.model.constrain(squares.x) - self.mean) / self.sd
        self.assertLess(distance.max(), 0.5, dict(zip(self.model.names, distance)))


if __name__ == "__main__":
    unittest.main()
