# The program `canonform` in a small image that serves an index:
#
#     docker build -t canonform .
#     docker run --rm -p 127.0.0.1:7878:7878 -v "$PWD/indexes:/data:ro" canonform
#
# The index is /data/shapes.canonform, its meshes lie beside it. Stop the container while the index changes, or let the user
# 65532 write the folder. Other commands: `docker run ... canonform compare a.off b.off`.

FROM --platform=$BUILDPLATFORM rust:1.90-slim-bookworm AS build
ARG BUILDARCH
ARG TARGETARCH
# A linker of the other processor, if the image is not for this one.
# hadolint ignore=DL3008
RUN if [ "$TARGETARCH" != "$BUILDARCH" ] && [ "$TARGETARCH" = arm64 ]; then \
      apt-get update && apt-get install -y --no-install-recommends gcc-aarch64-linux-gnu libc6-dev-arm64-cross \
      && rm -rf /var/lib/apt/lists/*; \
    fi
ENV CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
WORKDIR /source
COPY . .
RUN case "$TARGETARCH" in \
      amd64) triple=x86_64-unknown-linux-gnu ;; \
      arm64) triple=aarch64-unknown-linux-gnu ;; \
      *) echo "no build for $TARGETARCH" >&2; exit 1 ;; \
    esac \
    && if [ "$TARGETARCH" = "$BUILDARCH" ]; then unset CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER; fi \
    && rustup target add "$triple" \
    && cargo build --release --locked -p canonform-cli --target "$triple" \
    && cp "target/$triple/release/canonform" /canonform

FROM busybox:1.37.0-musl AS tools

# glibc and libgcc, no shell and no package manager; the user is 65532.
FROM gcr.io/distroless/cc-debian12:nonroot
LABEL org.opencontainers.image.title="canonform" \
      org.opencontainers.image.description="Nonrigid 3D shape retrieval by canonical forms" \
      org.opencontainers.image.licenses="MIT OR Apache-2.0" \
      org.opencontainers.image.source="https://github.com/canonform/canonform"
COPY --from=build /canonform /usr/local/bin/canonform
COPY --from=tools /bin/busybox /usr/local/bin/busybox
COPY LICENSE-MIT LICENSE-APACHE /licenses/
WORKDIR /data
VOLUME /data
USER 65532:65532
EXPOSE 7878
HEALTHCHECK --interval=30s --timeout=5s --start-period=60s \
  CMD ["/usr/local/bin/busybox", "wget", "-q", "-O", "/dev/null", "http://127.0.0.1:7878/healthz"]
STOPSIGNAL SIGTERM
ENTRYPOINT ["/usr/local/bin/canonform"]
CMD ["serve", "/data/shapes.canonform", "--listen", "0.0.0.0:7878"]
