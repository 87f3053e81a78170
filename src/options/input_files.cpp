#include "options/input_files.hpp"

#include "base/rank_zero.hpp"
#include "io/checksum.hpp"
#include "io/nrrd_header.hpp"
#include "io/volume_file.hpp"
#include "options/option_table.hpp"

#include <filesystem>
#include <fstream>

namespace eulastic {
namespace {

// The files that a path stands for: itself, without the dataset of FILE:DATASET, and what a detached NRRD header names.
std::vector<std::string> files_of(const std::string &path) {
  VolumeFormat format{};
  std::string file, dataset;
  NrrdHeader header;
  // Whoever loads the file says what is wrong with it.
  if (find_volume(path, &format, &file, &dataset).empty() && format == VolumeFormat::nrrd)
    (void)read_nrrd_header(file, &header);
  if (header.data_file.empty() || header.data_file == file) return {file};
  return {file, header.data_file};
}

// Of all bytes of the files, one after the other.
std::string hash_files(const std::vector<std::string> &files) {
  std::vector<std::uint64_t> words(1 << 16);
  std::uint64_t sum = 0, count = 0;
  for (const std::string &path : files) {
    std::ifstream file(path, std::ios::binary);
    for (std::size_t bytes = 1; bytes > 0; count += words.size()) {
      std::fill(words.begin(), words.end(), 0);
      file.read(reinterpret_cast<char *>(words.data()), static_cast<std::streamsize>(words.size() * sizeof words[0]));
      bytes = static_cast<std::size_t>(file.gcount());
      sum += checksum(words.data(), (bytes + sizeof words[0] - 1) / sizeof words[0], count) + mix_bits(bytes);
    }
  }
  return checksum_text(sum);
}

}  // namespace

std::vector<InputFile> hash_input_files(const Config &config) {
  Config copy = config;
  std::vector<InputFile> files;
  for (const Option &option : option_table(copy)) {
    if (!option.names_file || !option.text || (option.applies && !option.applies())) continue;
    const std::string path = option.text();
    if (path.empty() || !option.names_file(path)) continue;
    files.push_back({option.name, path, on_rank_0([&] { return hash_files(files_of(path)); })});
  }
  return files;
}

}  // namespace eulastic
