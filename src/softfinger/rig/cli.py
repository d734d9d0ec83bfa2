"""`softfinger rig`: record a campaign, or simulate a rig."""

import contextlib
import signal
from pathlib import Path
from typing import Annotated

import typer

from softfinger.faults import Fault

RESERVED_COLUMNS = ("trial", "started_at", "video", "markers", "angles", "load")

app = typer.Typer(
    help="Record a campaign with a camera and a serial motor controller.", no_args_is_help=True
)


@app.command(epilog="Example: `softfinger rig simulate --time-scale 10`")
def simulate(
    time_scale: Annotated[float, typer.Option(help="Simulated seconds per second.", min=0.1)] = 1.0,
    fps: Annotated[float, typer.Option(help="Frame rate of the virtual camera.", min=1.0)] = 30.0,
    seed: Annotated[int, typer.Option(help="Seed of the virtual finger.", min=0)] = 0,
    watchdog_s: Annotated[
        float, typer.Option(help="Silence after which the wire is released [s].")
    ] = 1.0,
    transcript: Annotated[
        Path | None, typer.Option(help="File for every line that is sent.")
    ] = None,
) -> None:
    """Simulate a rig: controller, finger and camera.

    The controller is on a pseudo-terminal. Prints port and camera, then runs until interrupted.
    """
    from softfinger.rig.device import DeviceSettings
    from softfinger.rig.simulator import simulate as serve

    _end_by_interrupt()
    settings = DeviceSettings(time_scale=time_scale, watchdog_s=watchdog_s)
    with contextlib.suppress(KeyboardInterrupt):
        serve(settings, fps, seed, transcript)


@app.command(
    epilog="Example: `softfinger rig record plan.yaml --out my_campaign --port /dev/ttyACM0`"
)
def record(
    plan: Annotated[Path, typer.Argument(help="The plan; docs/rig/plan.yaml is an example.")],
    out: Annotated[Path, typer.Option(help="Campaign folder, new or to continue.")],
    port: Annotated[str, typer.Option(help="Serial port of the motor controller.")],
    camera: Annotated[str, typer.Option(help="Camera: number, path, or virtual:PORT.")] = "0",
    environment: Annotated[
        list[str] | None,
        typer.Option(help="Column for trials.csv, as in temperature_c=23.5; may be repeated."),
    ] = None,
) -> None:
    """Record the trials of PLAN that OUT lacks.

    Ctrl-C releases the wire and ends.
    """
    from softfinger.rig.recorder import record_campaign

    noted = dict(_read_environment(text) for text in environment or [])
    _end_by_interrupt()
    record_campaign(plan, out, port, camera, noted)


def _read_environment(text: str) -> tuple[str, float]:
    column, _, value = text.partition("=")
    try:
        if not column.isidentifier() or column in RESERVED_COLUMNS:
            raise ValueError(column)
        return column, float(value)
    except ValueError:
        raise Fault(
            f"--environment {text}: expected column=number, as in temperature_c=23.5; the column "
            f"must not be one of {', '.join(RESERVED_COLUMNS)}"
        ) from None


def _end_by_interrupt() -> None:
    """Let closed terminals and SIGTERM end as Ctrl-C does."""
    for ending in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(ending, signal.default_int_handler)
