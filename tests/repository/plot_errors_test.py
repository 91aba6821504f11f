"""scripts/plot_errors: the Pareto front, and pictures that gnuplot really draws."""

import importlib.machinery
import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "scripts"))  # for what the plots share
SCRIPT = pathlib.Path(__file__).parents[2] / "scripts" / "plot_errors"
HEADER = "curve,setting,frame_ms_median,frame_ms_min,frame_ms_max,error_px_p99,flip_mean\n"


def load():
    loader = importlib.machinery.SourceFileLoader("plot_errors", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("plot_errors", loader))
    loader.exec_module(module)
    return module


def write_run(folder, name, rows):
    run = pathlib.Path(folder) / name
    run.mkdir()
    (run / "errors.csv").write_text(HEADER + "".join(row + "\n" for row in rows), encoding="utf-8")
    return run


class PlotErrorsTest(unittest.TestCase):
    def test_the_front_holds_what_nothing_beats_in_both(self):
        points = [(10, 9, 11, 1.0, "a"), (20, 19, 21, 0.1, "b"), (15, 14, 16, 2.0, "beaten"), (30, 29, 31, 0.1, "slower")]
        self.assertEqual([point[4] for point in load().pareto_front(points)], ["a", "b"])

    def test_curves_of_several_runs_are_told_apart_by_what_differs_in_their_names(self):
        with tempfile.TemporaryDirectory() as folder:
            runs = [write_run(folder, "alps.tolerance", ['"auto","auto 1 px",1,1,1,0.5,0.1']),
                    write_run(folder, "alps.method", ['"hull","hull",2,2,2,0.2,0.1'])]
            curves = load().points_of(runs, "error_px_p99")
        self.assertEqual(curves, {"tolerance: auto": [(1, 1, 1, 0.5, "auto 1 px")],
                                  "method: hull": [(2, 2, 2, 0.2, "hull")]})

    def test_gnuplot_draws_both_pictures_and_an_error_of_zero_is_told(self):
        with tempfile.TemporaryDirectory() as folder:
            run = write_run(folder, "run", ['"auto","auto 1 px",10,9,11,0.5,0.1', '"auto","auto 2 px",8,7,9,2.0,0.2',
                                            '"exact","exact",100,90,110,0,0'])
            out = pathlib.Path(folder) / "plot"
            done = subprocess.run([sys.executable, SCRIPT, out, run], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stderr, "plot_errors: exact has the error 0 and is drawn on the lower border\n")
            self.assertIn("exact", out.with_suffix(".svg").read_text(encoding="utf-8"))
            self.assertEqual(out.with_suffix(".png").read_bytes()[:4], b"\x89PNG")

    def test_a_narrow_axis_has_numbers_too(self):
        self.assertEqual(load().tics("x", [17.5, 39]), "set xtics (10, 15, 20, 30, 40, 50, 60)")
        self.assertEqual(load().tics("x", [1, 300]), "set xtics autofreq")

    def test_an_unknown_column_is_refused_by_name(self):
        with tempfile.TemporaryDirectory() as folder:
            run = write_run(folder, "run", ['"auto","auto",10,9,11,0.5,0.1'])
            done = subprocess.run([sys.executable, SCRIPT, "--error", "colour", f"{folder}/plot", run],
                                  capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("has no column colour; it has curve, setting", done.stderr)


if __name__ == "__main__":
    unittest.main()
