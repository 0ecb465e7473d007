"""Build a dataset on a cluster: start Dask workers there, build on them, stop them.

    pip install dask-jobqueue       # or dask-kubernetes
    python scripts/build_on_cluster.py slurm --jobs 64 -- d2 --preset paper -o data/d2
    python scripts/build_on_cluster.py kubernetes --jobs 64 --image IMAGE -- d2 -o data/d2

What follows `--` goes to `garmentimage build`. Run it where the shards shall lie: only this
process writes files. All workers need garmentimage with its `data` extra, in the same versions: for
Slurm in the environment of the Python that runs this, on a disk that all nodes share; for
Kubernetes in IMAGE. A worker has one core. Workers that the cluster takes away lose nothing but
their unfinished shards, which others make again.
"""

import argparse
import sys
from typing import Any

from garmentimage.cli.app import main as garmentimage


def slurm(options: argparse.Namespace) -> Any:
    """One worker a job; add here what your site asks for, such as `job_extra_directives`."""
    from dask_jobqueue import SLURMCluster

    cluster = SLURMCluster(
        cores=1,
        processes=1,
        memory=options.memory,
        walltime=options.walltime,
        queue=options.queue,
        python=sys.executable,
    )
    cluster.scale(jobs=options.jobs)
    return cluster


def kubernetes(options: argparse.Namespace) -> Any:
    """Needs the Dask operator in the cluster: helm install dask-kubernetes-operator."""
    from dask_kubernetes.operator import KubeCluster

    return KubeCluster(
        name="garmentimage",
        image=options.image,
        n_workers=options.jobs,
        resources={"requests": {"cpu": "1", "memory": options.memory}},
        worker_command=["dask", "worker", "--nthreads", "1"],
    )


def main() -> int:
    """Start the workers, build, stop them."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("on", choices=("slurm", "kubernetes"))
    parser.add_argument("--jobs", type=int, default=8, help="workers, of one core each (8)")
    parser.add_argument("--memory", default="2GB", help="of each worker (2GB)")
    parser.add_argument("--walltime", default="04:00:00", help="of each Slurm job")
    parser.add_argument("--queue", help="Slurm partition")
    parser.add_argument("--image", help="Docker image of the Kubernetes workers")
    parser.add_argument("build", nargs="+", help="arguments of `garmentimage build`, after --")
    options = parser.parse_args()
    try:
        started = {"slurm": slurm, "kubernetes": kubernetes}[options.on](options)
    except ModuleNotFoundError as error:
        parser.error(f"needs {error.name}: pip install {error.name.replace('_', '-')}")
    with started as cluster:
        cluster.wait_for_workers(1)
        return garmentimage(["build", *options.build, "--scheduler", cluster.scheduler_address])


if __name__ == "__main__":
    sys.exit(main())
