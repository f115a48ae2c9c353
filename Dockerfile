# tachk with everything that it can read and draw:
#
#   docker build -t tachk .
#   docker run --rm -v "$PWD:/work" tachk verify model.ta
FROM python:3.13-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends g++ && rm -rf /var/lib/apt/lists/*
COPY . /source
RUN pip wheel --no-cache-dir --no-deps --wheel-dir /wheels /source

FROM python:3.13-slim
COPY --from=build /wheels /wheels
RUN pip install --no-cache-dir "$(ls /wheels/*.whl)[plot,data,parquet,mcap,hdf5,mcp]" && rm -r /wheels \
    && useradd --create-home user
USER user
WORKDIR /work
ENTRYPOINT ["tachk"]
CMD ["--help"]
