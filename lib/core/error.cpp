// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/error.hpp"

#include <algorithm>
#include <utility>

namespace petzval {
namespace {

constexpr std::size_t max_message_size = 1000;

std::string one_line(std::string message) {
  if (message.size() > max_message_size) {
    const std::string cut = " ... ";
    const std::size_t half = (max_message_size - cut.size()) / 2;
    message = message.substr(0, half) + cut + message.substr(message.size() - half);
  }
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  std::replace_if(message.begin(), message.end(), is_control, ' ');
  return message;
}

}  // namespace

Error::Error(std::string message) : std::runtime_error(one_line(std::move(message))) {}

Error::~Error() = default;  // anchors the type information in this library, so that other libraries can catch an Error

}  // namespace petzval
