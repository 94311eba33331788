#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# pkg_config.sh COMPILER LIBDIR SOURCE WORK [ARGUMENT...]: builds a program with the flags of pkg-config and runs it.
set -eu
compiler=$1 libdir=$2 source=$3 work=$4
shift 4
export PKG_CONFIG_PATH="$libdir/pkgconfig"
mkdir -p "$work"
"$compiler" -std=c++20 "-DCONSUMER_DATA=\"$("$PKG_CONFIG" --variable=datadir petzval-core)\"" $("$PKG_CONFIG" --cflags petzval-core) "$source" -o "$work/consumer" \
  $("$PKG_CONFIG" --libs petzval-core) "-Wl,-rpath,$libdir"
exec "$work/consumer" "$@"
