#!/usr/bin/env bash
# System packages that darkflat needs on Debian 12 or Ubuntu 22.04 and later. The image asks for
# `service`, a checkout (`make setup`, and so CI) for `service tests`. Does nothing where they are
# there already.
set -euo pipefail

# Aravis with its introspection data, and what PyGObject is built with.
service=(gir1.2-aravis-0.8 libgirepository1.0-dev gcc pkg-config libcairo2-dev python3-venv)
# What runs the checkout, a PostgreSQL server for the store's tests, the browser for the page's.
tests=(make postgresql chromium)

packages=()
for needs in "$@"; do
    case "$needs" in
        service) packages+=("${service[@]}") ;;
        tests) packages+=("${tests[@]}") ;;
        *) echo "usage: $0 [service] [tests]" >&2; exit 2 ;;
    esac
done
[ "${#packages[@]}" -gt 0 ] || { echo "usage: $0 [service] [tests]" >&2; exit 2; }

missing=()
for package in "${packages[@]}"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
[ "${#missing[@]}" -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
        echo "missing system packages: ${missing[*]}; as root: apt-get install ${missing[*]}" >&2
        exit 1
    }
    as_root=(sudo)
fi
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" apt-get install -y -q --no-install-recommends "${missing[@]}"
