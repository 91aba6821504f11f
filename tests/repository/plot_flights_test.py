"""scripts/plot_flights: pictures that gnuplot really draws, of runs that measured all or only a part."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).parents[2] / "scripts" / "plot_flights"
HEADER = ("frame,seconds,frame_ms,nodes,uploaded,host_bytes,gpu_heights_bytes,gpu_maxima_bytes,gpu_method_bytes,"
          "gpu_imagery_bytes,gpu_targets_bytes,gpu_buffers_bytes,steps_mean,steps_p99\n")


def write_run(folder, name, steps, frames=20):
    run = pathlib.Path(folder) / name
    run.mkdir()
    lines = [f"{n},{n / 30},{10 + n % 7},{50 + n},{n % 3},{n * 1000000},1000000,300000,0,2000000,50000,4000,{steps}\n"
             for n in range(frames)]
    (run / "frames.csv").write_text(HEADER + "".join(lines), encoding="utf-8")
    return run


def plot(*arguments):
    return subprocess.run([sys.executable, SCRIPT, *arguments], capture_output=True, text=True, check=False)


class PlotFlightsTest(unittest.TestCase):
    def test_gnuplot_overlays_runs_in_four_plots_and_tells_their_names(self):
        with tempfile.TemporaryDirectory() as folder:
            runs = [write_run(folder, "alps.raster", "5.5,20"), write_run(folder, "alps.compute_2", "6,21")]
            out = pathlib.Path(folder) / "plot"
            done = plot(out, *runs)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn("40 frames of 2 runs", done.stdout)
            svg = out.with_suffix(".svg").read_text(encoding="utf-8")
            self.assertEqual(out.with_suffix(".png").read_bytes()[:4], b"\x89PNG")
        for text in ("raster", "compute_2", "frame, ms", "memory, MB", "steps a ray", "tiles", "flight, s"):
            self.assertIn(f">{text}<", svg)
        self.assertNotIn("alps", svg)

    def test_what_no_run_measured_is_left_out(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "plot"
            done = plot(out, write_run(folder, "run", ","))
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            svg = out.with_suffix(".svg").read_text(encoding="utf-8")
        self.assertNotIn("steps a ray", svg)
        self.assertIn(">tiles<", svg)

    def test_one_frame_is_a_run(self):
        with tempfile.TemporaryDirectory() as folder:
            done = plot(f"{folder}/plot", write_run(folder, "run", "5,20", frames=1))
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_what_is_no_run_is_refused_by_name(self):
        with tempfile.TemporaryDirectory() as folder:
            done = plot(f"{folder}/plot", folder)
            self.assertEqual(done.returncode, 1)
            self.assertIn("has no frames.csv", done.stderr)
            done = plot(f"{folder}/plot", write_run(folder, "empty", "5,20", frames=0))
            self.assertEqual(done.returncode, 1)
            self.assertIn("has no frames with seconds", done.stderr)


if __name__ == "__main__":
    unittest.main()
