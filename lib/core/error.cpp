// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/error.hpp"

#include <utility>

#include "core/text.hpp"

namespace petzval {
namespace {

constexpr std::size_t max_message_size = 1000;

std::string shortened(std::string message) {
  if (message.size() > max_message_size) {
    const std::string cut = " ... ";
    const std::size_t half = (max_message_size - cut.size()) / 2;
    message = message.substr(0, half) + cut + message.substr(message.size() - half);
  }
  return message;
}

}  // namespace

Error::Error(std::string message) : std::runtime_error(one_line(shortened(std::move(message)))) {}

Error::~Error() = default;  // anchors the type information in this library, so that other libraries can catch an Error

}  // namespace petzval
