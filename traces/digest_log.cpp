#include "traces/digest_log.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>

#include "core/file_bytes.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

constexpr std::string_view kWhat = "digest log";
constexpr std::string_view kFirstWords = "pelt digest log ";
constexpr std::string_view kColumnsLine = "columns frame stage stream digest";
constexpr size_t kNameBytesLimit = 64;
constexpr size_t kTextBytesLimit = 512;
constexpr size_t kColumnsLimit = 1024;
constexpr std::string_view kNoSettings = "none";

std::string OnOneLine(std::string_view text) {
  std::string line = Printable(text);
  line.resize(std::min<size_t>(line.size(), kTextBytesLimit));
  while (!IsPrintable(line)) line.pop_back();  // a character that the cut went through
  return line;
}

bool IsName(std::string_view word) {
  return !word.empty() && word.size() <= kNameBytesLimit &&
         std::all_of(word.begin(), word.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '_' || c == '-' || c == '.';
         });
}

// The whole word is the number, in the one way this program writes it.
template <class T>
std::optional<T> ParseNumber(std::string_view word) {
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  if (word.size() > 1 && word[0] == '0') return std::nullopt;
  return value;
}

std::optional<uint64_t> ParseDigest(std::string_view word) {
  uint64_t value = 0;
  if (word.size() != 16) return std::nullopt;
  for (const char c : word) {
    const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
    if (digit < 0) return std::nullopt;
    value = value << 4 | uint64_t(digit);
  }
  return value;
}

// Goes through the lines. The first failure stays; after it every line is empty and every number 0.
class Reader {
 public:
  Reader(std::string_view text, const std::string& name, std::string& error)
      : text_(text), name_(name), error_(error) {}

  void Fail(const std::string& reason) {
    if (!failed_) error_ = Format("{} '{}', line {}: {}", kWhat, name_, line_, reason);
    failed_ = true;
  }
  bool failed() const { return failed_; }
  std::string_view Line() {
    ++line_;
    const size_t end = text_.find('\n');
    if (end == std::string_view::npos) {
      Fail(text_.empty() ? "the file ends here, before its 'end' line: it was cut"
                         : "the last line has no end: the file was cut");
      return {};
    }
    const std::string_view line = text_.substr(0, end);
    text_.remove_prefix(end + 1);
    return line;
  }
  // What follows `key` and a blank; the line must begin with them.
  std::string_view Value(std::string_view key) {
    const std::string_view line = Line();
    if (line.substr(0, key.size()) == key && line.size() > key.size() && line[key.size()] == ' ')
      return line.substr(key.size() + 1);
    Fail(Format("should be '{} ...'", key));
    return {};
  }
  std::string Text(std::string_view key) {
    const std::string_view value = Value(key);
    if (value.size() > kTextBytesLimit) {
      Fail(Format("{} of more than {} bytes", key, kTextBytesLimit));
    } else if (OnOneLine(value) != value) {
      Fail(Format("{} holds a control character", key));
    }
    return std::string(value.substr(0, kTextBytesLimit));
  }
  uint32_t Number(std::string_view key) {
    const auto number = ParseNumber<uint32_t>(Value(key));
    if (!number) Fail(Format("{} is not a whole number", key));
    return number.value_or(0);
  }
  size_t BytesLeft() const { return text_.size(); }

 private:
  std::string_view text_;
  const std::string& name_;
  std::string& error_;
  size_t line_ = 0;
  bool failed_ = false;
};

struct Entry {
  uint32_t frame = 0;
  std::string_view stage, stream;
  uint64_t digest = 0;
};

Entry ParseEntry(Reader& reader, std::string_view line) {
  std::string_view word[4];
  for (int w = 0; w < 4; ++w) {
    const size_t end = w < 3 ? line.find(' ') : line.size();
    if (end == std::string_view::npos) {
      reader.Fail("should be 'frame stage stream digest'");
      return {};
    }
    word[w] = line.substr(0, end);
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  const auto frame = ParseNumber<uint32_t>(word[0]);
  const auto digest = ParseDigest(word[3]);
  if (!frame) reader.Fail("the frame is not a whole number");
  if (!IsName(word[1]) || !IsName(word[2])) reader.Fail("the stage or the stream is not a name");
  if (!digest) reader.Fail("the digest is not 16 hex digits");
  return {frame.value_or(0), word[1], word[2], digest.value_or(0)};
}

void ReadFrames(Reader& reader, uint32_t frames, DigestLog& log) {
  std::string_view line = reader.Line();
  for (uint32_t f = 0; f < frames; ++f) {
    for (size_t c = 0; f == 0 || c < log.columns.size(); ++c) {
      const Entry entry = ParseEntry(reader, line);
      // The first frame says which lines every frame has; it ends with the whole frame's.
      if (f == 0) {
        if (c == kColumnsLimit) reader.Fail(Format("more than {} lines per frame", c));
        if (!reader.failed())
          log.columns.push_back({std::string(entry.stage), std::string(entry.stream)});
      }
      if (entry.frame != f) reader.Fail(Format("should be of frame {}", f));
      if (reader.failed()) return;
      if (entry.stage != log.columns[c].stage || entry.stream != log.columns[c].stream)
        return reader.Fail(Format("should be of stage {}, stream {}, as in frame 0",
                                  log.columns[c].stage, log.columns[c].stream));
      log.digests.push_back(entry.digest);
      line = reader.Line();
      if (f == 0 && entry.stage == kWholeFrameStage) break;
    }
  }
  if (line != Format("end {}", log.digests.size()))
    reader.Fail(Format("should be 'end {}': a line is missing or too many", log.digests.size()));
  if (reader.BytesLeft() != 0)
    reader.Fail(Format("{} bytes behind the 'end' line", reader.BytesLeft()));
}

}  // namespace

std::string WriteDigestLog(const DigestLog& log) {
  std::string out = Format("{}{}\n", kFirstWords, kDigestLogVersion);
  out += Format("scene {}\n", OnOneLine(log.scene));
  out += Format("settings {}\n", log.settings.empty() ? kNoSettings : OnOneLine(log.settings));
  out += Format("chunk_strands {}\n", log.chunk_strands);
  out += Format("vertex_order {}\n", log.vertex_order);
  out += Format("frames {}\n{}\n", log.FrameCount(), kColumnsLine);
  for (uint32_t f = 0; f < log.FrameCount(); ++f) {
    const std::span<const uint64_t> digests = log.Frame(f);
    for (size_t c = 0; c < log.columns.size(); ++c)
      FormatTo(out, "{} {} {} {:016x}\n", f, log.columns[c].stage, log.columns[c].stream,
               digests[c]);
  }
  return out + Format("end {}\n", log.digests.size());
}

Result<DigestLog> ReadDigestLog(std::string_view text, const std::string& name) {
  if (!LooksLikeDigestLog(AsBytes(text)))
    return Failure{Format("{} '{}', line 1: not a digest log", kWhat, name)};
  std::string error;
  Reader reader(text, name, error);
  const std::string_view version = reader.Line();
  if (!reader.failed() && version != Format("{}{}", kFirstWords, kDigestLogVersion))
    reader.Fail(Format("version {}, this program reads {}",
                       OnOneLine(version.substr(kFirstWords.size(), 20)), kDigestLogVersion));
  DigestLog log;
  log.scene = reader.Text("scene");
  log.settings = reader.Text("settings");
  if (log.settings == kNoSettings) log.settings.clear();
  log.chunk_strands = reader.Number("chunk_strands");
  log.vertex_order = reader.Text("vertex_order");
  if (log.vertex_order != "sorted" && log.vertex_order != "index-buffer")
    reader.Fail("vertex_order is neither 'sorted' nor 'index-buffer'");
  const uint32_t frames = reader.Number("frames");
  if (reader.Line() != kColumnsLine) reader.Fail(Format("should be '{}'", kColumnsLine));
  if (!reader.failed()) ReadFrames(reader, frames, log);
  if (reader.failed()) return Failure{std::move(error)};
  return log;
}

Result<DigestLog> ReadDigestLogFile(const std::string& path) {
  const auto bytes = ReadFileBytes(kWhat, path);
  if (!bytes) return Failure{bytes.error()};
  return ReadDigestLog(AsText(*bytes), path);
}

Result<> WriteDigestLogFile(const DigestLog& log, const std::string& path) {
  return WriteFileBytes(kWhat, path, AsBytes(WriteDigestLog(log)));
}

bool LooksLikeDigestLog(std::span<const std::byte> bytes) {
  return AsText(bytes).substr(0, kFirstWords.size()) == kFirstWords;
}

}  // namespace pelt
