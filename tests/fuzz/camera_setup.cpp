// SPDX-License-Identifier: Apache-2.0
// Set-ups of cameras in memory: each is read or refused with a message.
#include <cstring>

#include "laws.hpp"
#include "petzval/petzval.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  petzval_camera* camera = nullptr;
  const petzval_status status = petzval_camera_read(reinterpret_cast<const char*>(data), size, &camera);
  petzval::fuzz::require((status == PETZVAL_OK) == (camera != nullptr), "a camera is made if the status is OK");
  petzval::fuzz::require(status == PETZVAL_OK || std::strlen(petzval_message()) > 0, "a failed call has a message");
  petzval_camera_free(camera);
  return 0;
}
