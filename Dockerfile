# castx with everything it needs:
#
#     docker build -t castx .
#     docker run --rm -v "$PWD:/work" castx run case.toml
#     docker run --rm -v "$PWD:/work" --entrypoint mpirun castx -n 2 castx run case.toml
FROM debian:trixie

# One thread per MPI rank; Open MPI as root, on fewer cores than ranks, on one machine.
ENV OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 \
    OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_btl=self,sm \
    PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
    PATH=/opt/castx/bin:$PATH

COPY bin/dpkg-excludes.conf /etc/dpkg/dpkg.cfg.d/castx
COPY bin/debian-packages.txt /tmp/
RUN apt-get update \
    && sed 's/#.*//' /tmp/debian-packages.txt | xargs apt-get install -y -qq --no-install-recommends \
    && rm -rf /var/lib/apt/lists/*

# --no-deps: pip does not recognise all of Debian's packages (VTK has no metadata).
COPY . /castx
RUN python3 -m venv --system-site-packages --without-pip /opt/castx \
    && /opt/castx/bin/python -m pip install --no-index --no-deps --no-build-isolation /castx \
    && castx --help >/dev/null

WORKDIR /work
ENTRYPOINT ["castx"]
