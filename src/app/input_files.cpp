#include "app/input_files.hpp"

#include "app/option_table.hpp"
#include "base/rank_zero.hpp"
#include "io/checksum.hpp"

#include <filesystem>
#include <fstream>

namespace eulastic {
namespace {

std::string hash_file(const std::string &path) {
  std::error_code error;
  const std::size_t colon = path.rfind(':');
  const bool whole = std::filesystem::is_regular_file(path, error) || colon == std::string::npos;  // else FILE:DATASET
  std::ifstream file(whole ? path : path.substr(0, colon), std::ios::binary);
  std::vector<std::uint64_t> words(1 << 16);
  std::uint64_t sum = 0, count = 0;
  for (std::size_t bytes = 1; bytes > 0; count += words.size()) {
    std::fill(words.begin(), words.end(), 0);
    file.read(reinterpret_cast<char *>(words.data()), static_cast<std::streamsize>(words.size() * sizeof words[0]));
    bytes = static_cast<std::size_t>(file.gcount());
    sum += checksum(words.data(), (bytes + sizeof words[0] - 1) / sizeof words[0], count) + mix_bits(bytes);
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
    files.push_back({option.name, path, on_rank_0([&] { return hash_file(path); })});
  }
  return files;
}

}  // namespace eulastic
