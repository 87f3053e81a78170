// NRRD volumes, read from the front.
#include "base/number_rows.hpp"
#include "io/nrrd_header.hpp"
#include "io/volume_file.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace eulastic {
namespace {

const char *const truncated = "its data end too early; it is truncated or damaged";
const char *const damaged = "its gzip data are damaged";

class NrrdVolume : public VolumeFile {
public:
  ~NrrdVolume() override {
    if (stream_) (void)gzclose(stream_);
  }

  std::string open(const std::string &file) {
    file_ = file;
    if (std::string wrong = read_nrrd_header(file, &header_); !wrong.empty()) return wrong;
    std::error_code error;
    const double bytes = double(std::filesystem::file_size(header_.data_file, error)) - double(header_.data);
    const bool ascii = header_.encoding == Encoding::ascii;
    // A value takes a digit and a space (the last one may lack it); deflate packs at most 1032 : 1.
    const double most = header_.encoding == Encoding::gzip ? 1032 * bytes : ascii ? bytes + 1 : bytes;
    if (std::string wrong = set_count(header_.sizes, ascii ? 2 : header_.bytes, most); !wrong.empty()) return wrong;
    if (std::string wrong = set_spacing(header_.spacing); !wrong.empty()) return wrong;
    std::copy(header_.corner.begin(), header_.corner.end(), corner_.begin());
    // zlib reads uncompressed files unchanged.
    const int descriptor = ::open(header_.data_file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0 || ::lseek(descriptor, header_.data, SEEK_SET) < 0 || !(stream_ = gzdopen(descriptor, "rb"))) {
      if (descriptor >= 0) (void)::close(descriptor);
      return header_.data_file + " cannot be read";
    }
    (void)gzbuffer(stream_, 1 << 18);
    if ((gzdirect(stream_) == 0) != (header_.encoding == Encoding::gzip))
      return file + ": its data are " + (gzdirect(stream_) ? "not " : "") + "packed by gzip, the header says otherwise";
    return {};
  }

protected:
  std::string read_values(const Int3 &begin, const Int3 &end, double *values) override {
    for (int k = begin[2]; k < end[2]; ++k)
      for (int j = begin[1]; j < end[1]; ++j, values += end[0] - begin[0]) {
        const std::int64_t row = (std::int64_t{k} * count_[1] + j) * count_[0];
        const int width = end[0] - begin[0];
        const std::string wrong = header_.encoding == Encoding::ascii ? read_words(row + begin[0], width, values)
                                                                      : read_bytes(row + begin[0], width, values);
        if (!wrong.empty()) return wrong;
      }
    return {};
  }

private:
  using Encoding = NrrdHeader::Encoding;

  std::string read_bytes(std::int64_t first, int count, double *values) {
    const int size = header_.bytes;
    bytes_.resize(static_cast<std::size_t>(count) * size);
    if (gzseek(stream_, static_cast<z_off_t>(first * size), SEEK_SET) < 0) return truncated;
    const int got = gzread(stream_, bytes_.data(), static_cast<unsigned>(bytes_.size()));
    if (got != static_cast<int>(bytes_.size())) return got < 0 ? damaged : truncated;
    for (int v = 0; v < count; ++v) values[v] = value_of(bytes_.data() + static_cast<std::size_t>(v) * size);
    // Behind the last value zlib verifies the checksum.
    char more;
    if (first + count < std::int64_t{count_[0]} * count_[1] * count_[2]) return {};
    int problem = gzread(stream_, &more, 1) < 0 ? Z_DATA_ERROR : Z_OK;
    if (problem == Z_OK) (void)gzerror(stream_, &problem);
    return problem == Z_BUF_ERROR ? truncated : problem != Z_OK ? damaged : "";
  }

  double value_of(unsigned char *bytes) const {
    const int size = header_.bytes;
    if (!header_.is_float) return std::any_of(bytes, bytes + size, [](unsigned char b) { return b != 0; });
    if (header_.big_endian) std::reverse(bytes, bytes + size);  // all machines that we know are little-endian
    float single;
    double real;
    if (size == 4) {
      std::memcpy(&single, bytes, 4);
      return single;
    }
    std::memcpy(&real, bytes, 8);
    return real;
  }

  std::string read_words(std::int64_t first, int count, double *values) {
    for (; next_ < first + count; ++next_) {
      std::string word;
      int c = gzgetc(stream_);
      while (c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == ',') c = gzgetc(stream_);
      for (; c > ' ' && c != ',' && word.size() < 64; c = gzgetc(stream_)) word += static_cast<char>(c);
      if (word.empty()) return truncated;
      if (next_ < first) continue;
      double value = 0;
      if (!read_number(word, &value) || (!header_.is_float && value != std::floor(value)))
        return "\"" + word + "\" is not " + (header_.is_float ? "a number" : "an integer");
      values[next_ - first] = header_.is_float ? value : value != 0;
    }
    return {};
  }

  NrrdHeader header_;
  gzFile stream_ = nullptr;
  std::int64_t next_ = 0;  // ascii: words read
  std::vector<unsigned char> bytes_;
};

}  // namespace

std::string open_nrrd_volume(const std::string &file, std::unique_ptr<VolumeFile> *volume) {
  auto opened = std::make_unique<NrrdVolume>();
  std::string wrong = opened->open(file);
  if (wrong.empty()) *volume = std::move(opened);
  return wrong;
}

}  // namespace eulastic
