// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#if defined(_WIN32)
#include <io.h>
#include <process.h>
#else
#include <unistd.h>
#endif

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "core/open_file.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

namespace fs = std::filesystem;

void check(bool done) {
  if (!done) throw std::system_error(errno, std::generic_category());
}

/// Functions whose names differ between systems. All return the results of the POSIX functions, and set errno.
#if defined(_WIN32)

using Mode = int;
int open_file(const fs::path& file, int flags, Mode mode) {
  return ::_wopen(file.c_str(), flags | _O_BINARY | _O_NOINHERIT, mode & (_S_IREAD | _S_IWRITE));
}
int sync(int descriptor) { return ::_commit(descriptor); }
std::optional<Mode> mode_of(const fs::path&) { return {}; }  // Windows: access rights are inherited from the folder
void set_mode(int, Mode) {}
int remove_file(const fs::path& file) { return ::_wunlink(file.c_str()); }

#else

using Mode = ::mode_t;
int open_file(const fs::path& file, int flags, Mode mode) { return ::open(file.c_str(), flags | O_CLOEXEC, mode); }
int sync(int descriptor) { return ::fsync(descriptor); }
std::optional<Mode> mode_of(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return {};
  return status.st_mode & 0777;
}
void set_mode(int descriptor, Mode mode) { static_cast<void>(::fchmod(descriptor, mode)); }
int remove_file(const fs::path& file) { return ::unlink(file.c_str()); }

#endif

class OpenFile {
 public:
  explicit OpenFile(int descriptor) noexcept : descriptor_(descriptor) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  int descriptor() const noexcept { return descriptor_; }

  void write(std::string_view bytes) const {
    constexpr std::size_t max_write_size = std::size_t{1} << 30;  // some systems refuse more in one call
    while (!bytes.empty()) {
      const auto count =
          ::write(descriptor_, bytes.data(), static_cast<unsigned>(std::min(bytes.size(), max_write_size)));
      check(count >= 0 || errno == EINTR);
      if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  /// Network file systems report some errors only on closing.
  void close() { check(::close(std::exchange(descriptor_, -1)) == 0); }

 private:
  int descriptor_;
};

/// A new file in the folder of another file, which it may replace. O_EXCL makes its name unique and follows no link.
class NewFile {
 public:
  /// Creates the file with the mode of the file to replace, or with the default mode.
  explicit NewFile(const fs::path& old) : file_(created(old)) {}
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile() {
    if (!name_.empty()) remove_file(name_);
  }

  void write(std::string_view bytes) {
    file_.write(bytes);
    check(sync(file_.descriptor()) == 0 || errno == EINVAL);  // EINVAL: the file system cannot sync
    file_.close();
  }

  void replace(const fs::path& old) {
    fs::rename(name_, old);
    name_.clear();
  }

 private:
  int created(const fs::path& old) {
    const std::optional<Mode> known = mode_of(old);
    const std::string prefix = ".petzval-" + std::to_string(::getpid()) + '-';
    for (int i = 0;; ++i) {
      name_ = old.parent_path() / (prefix + std::to_string(i));
      const int descriptor = open_file(name_, O_WRONLY | O_CREAT | O_EXCL, known.value_or(0666));
      if (descriptor < 0 && errno == EEXIST) continue;
      check(descriptor >= 0);
      if (known) set_mode(descriptor, *known);  // the umask removed bits
      return descriptor;
    }
  }

  fs::path name_;
  OpenFile file_;
};

/// The path that a new file may replace, after following links; nullopt for a pipe or a device.
std::optional<fs::path> link_target(fs::path file) {
  const auto type = fs::status(file).type();
  if (type != fs::file_type::regular && type != fs::file_type::not_found) return {};
  while (fs::is_symlink(fs::symlink_status(file))) file = file.parent_path() / fs::read_symlink(file);
  return file;
}

}  // namespace

void write_file(std::string_view bytes, const fs::path& file) {
  // The system would cut the name at a zero byte and overwrite another file.
  if (file.native().find(fs::path::value_type{}) != fs::path::string_type::npos) {
    throw Error(file.string() + ": the name contains a zero byte; must not");
  }
  core_detail::refuse_folder(file, "the name of a file");
  try {
    if (const auto target = link_target(file)) {
      NewFile replacement(*target);
      replacement.write(bytes);
      replacement.replace(*target);
    } else {
      OpenFile out(open_file(file, O_WRONLY, 0));
      check(out.descriptor() >= 0);
      out.write(bytes);
      out.close();
    }
  } catch (const std::system_error& error) {
    throw Error(file.string() + ": cannot be written (" + error.code().message() +
                "); must be in an existing, writable folder with space");
  }
}

std::string checksum(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  std::string digits(16, '0');
  for (std::size_t i = 0; i < digits.size(); ++i) digits[i] = "0123456789abcdef"[hash >> (60 - 4 * i) & 0xf];
  return digits;
}

void write_floats(std::span<const float> numbers, const std::filesystem::path& file) {
  static_assert(std::endian::native == std::endian::little);
  write_file({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()}, file);
}

std::vector<float> read_floats(const std::filesystem::path& file) {
  const std::string bytes = read_file(file, "a file of floats");
  if (bytes.size() % sizeof(float) != 0) {
    throw Error(file.string() + ": size = " + std::to_string(bytes.size()) +
                " bytes; must be a multiple of 4 (floats)");
  }
  std::vector<float> numbers(bytes.size() / sizeof(float));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

}  // namespace petzval
