// One class, over 400 lines: every operand form needs the message's place and the opcode's name.
#include "platform_sim/pipeline/listing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/format.hpp"
#include "platform_sim/pipeline/listing_text.hpp"

namespace pelt {
namespace {

constexpr uint32_t kInstructionBytes = 4;
constexpr uint32_t kMaxAlignBytes = 4096;

// What an opcode's pattern wants, in words.
std::string_view OperandInWords(std::string_view operand) {
  switch (operand.front()) {
    case 'i':
      return "immediate";
    case 'l':
      return "target";
    case 'h':
      return "branch";
    case 'n':
      return "channel";
    case 'k':
      return "condition";
    case 'm':
    case 'M':
      return "offset(register)";
    default:
      return "register";
  }
}

// A label that an instruction names, to be looked up when all are known.
struct Reference {
  uint32_t instruction;
  bool is_hinted_branch;
  std::string_view operand;
};

class ListingReader {
 public:
  ListingReader(std::string_view name, const InstructionSet& set, std::string& error)
      : error_(error) {
    listing_.name = name;
    listing_.set = &set;
  }

  std::optional<Listing> Read(std::string_view text) {
    uint32_t unclosed_line = 0;
    const std::string bare = WithoutComments(text, unclosed_line);
    if (unclosed_line) {
      line_ = unclosed_line;
      Fail("a comment begins with /* and does not end; expected */");
      return std::nullopt;
    }
    std::string why;
    const auto statements = WriteOutRepeats(SplitStatements(bare), why, line_);
    if (!statements) {
      Fail(why);
      return std::nullopt;
    }
    for (const Statement& statement : *statements) {
      line_ = statement.line;
      if (!ReadStatement(statement.text)) return std::nullopt;
    }
    if (listing_.program.empty()) {
      line_ = 1;
      Fail(Format("no instruction; expected a listing of {} instructions", listing_.set->name));
      return std::nullopt;
    }
    if (!ResolveReferences()) return std::nullopt;
    return std::move(listing_);
  }

 private:
  bool Fail(std::string_view what) {
    error_ = Format("{}:{}: {}", listing_.name, line_, what);
    return false;
  }

  bool ReadStatement(std::string_view text) {
    // Labels first, as many as there are.
    for (;;) {
      size_t end = 0;
      while (end < text.size() && IsWordChar(text[end])) ++end;
      const std::string_view rest = Trim(text.substr(end));
      if (end == 0 || !rest.starts_with(':')) break;
      if (!AddLabel(text.substr(0, end))) return false;
      text = Trim(rest.substr(1));
    }
    if (text.empty()) return true;
    const size_t end = std::min(text.find_first_of(" \t"), text.size());
    const std::string_view word = text.substr(0, end), operands = Trim(text.substr(end));
    if (word.front() == '.') return ReadDirective(word, operands);
    if (operands.starts_with('=')) return true;  // symbol = value
    return ReadInstruction(word, operands);
  }

  bool AddLabel(std::string_view name) {
    const bool numeric = std::ranges::all_of(name, IsDigit);
    std::vector<uint32_t>& places = places_[std::string(name)];
    if (!numeric && !places.empty())
      return Fail(
          Format("label '{}' a second time; every label needs a name of its own", Shown(name)));
    places.push_back(uint32_t(listing_.program.size()));
    listing_.labels.push_back({std::string(name), places.back()});
    return true;
  }

  bool ReadDirective(std::string_view word, std::string_view operands) {
    if (word == ".macro" || word.starts_with(".irp") || word.starts_with(".if") ||
        word == ".include")
      return Fail(
          Format("{} makes other statements of these; give the listing as the "
                 "assembler or compiler prints it, with everything written out",
                 word));
    const bool power = word == ".align" || word == ".p2align";
    if (!power && word != ".balign") return true;
    const auto arguments = SplitOperands(operands);
    const auto value = arguments.empty() ? std::nullopt : ParseInteger(arguments[0]);
    const bool in_range = value && *value >= 0 && *value <= (power ? 12 : int64_t{kMaxAlignBytes});
    const uint32_t bytes = !in_range ? 0 : power ? 1u << *value : uint32_t(*value);
    if (!in_range || (bytes & (bytes - 1)) != 0)
      return Fail(Format("{} {}; expected a power of two up to {} bytes", word, Shown(operands),
                         kMaxAlignBytes));
    while (bytes > kInstructionBytes && NextLocation() % bytes != 0)
      if (!ReadInstruction(
              NextLocation() % 8 == 0 ? listing_.set->even_padding : listing_.set->odd_padding, {}))
        return false;
    return true;
  }

  uint64_t NextLocation() const { return listing_.program.size() * kInstructionBytes; }

  bool ReadInstruction(std::string_view mnemonic, std::string_view operand_text) {
    const auto opcode = listing_.set->find(mnemonic);
    if (!opcode) return FailUnknown(mnemonic);
    const auto written = SplitOperands(operand_text);
    std::vector<std::string_view> wanted = SplitWords(opcode->operands);
    if (!LeaveOut(wanted, written.size()))
      return Fail(Format("'{}' has {} operand{}; expected {}", mnemonic, written.size(),
                         written.size() == 1 ? "" : "s", Usage(*opcode)));
    if (listing_.program.size() >= kMaxListingInstructions)
      return Fail(
          Format("more than {} instructions; give the loop that matters", kMaxListingInstructions));
    Instruction instruction;
    instruction.op_class = opcode->op_class;
    instruction.flow = opcode->flow;
    instruction.location_bytes = NextLocation();
    instruction.address.size_bytes = opcode->access_bytes;
    instruction.address.is_store = opcode->is_store;
    size_t next = 0;
    for (const std::string_view operand : wanted) {
      if (operand.front() == '+') {
        AddSpecial(instruction, operand);
      } else if (operand.back() == '?') {
        // A condition field that is not written down is cr0.
        if (operand[1] == 'c') Touch(instruction, operand.front(), kPpeCr);
      } else if (!ReadOperand(instruction, *opcode, operand, written[next++])) {
        return false;
      }
    }
    if (opcode->sets_cr != kNoRegister) instruction.writes.Add(opcode->sets_cr);
    listing_.program.push_back(instruction);
    listing_.text.push_back(Format("{} {}", mnemonic, fmt::join(written, ",")));
    if (written.empty()) listing_.text.back().pop_back();
    listing_.line.push_back(line_);
    return true;
  }

  bool FailUnknown(std::string_view mnemonic) {
    const InstructionSet& other =
        listing_.set == &SpuInstructionSet() ? PpeInstructionSet() : SpuInstructionSet();
    std::string hint;
    if (other.find(mnemonic))
      hint = Format(", and this is one of the {}'s", other.name);
    else if (listing_.program.empty())  // the first: hardly a slip of the pen
      hint = Format(
          "; is this of another machine, or a disassembly? Give what a compiler for the {} writes "
          "with -S",
          listing_.set->name);
    return Fail(
        Format("'{}' is no {} opcode; expected an opcode, a label with ':' or a "
               "directive with '.'{}",
               Shown(mnemonic), listing_.set->name, hint));
  }

  // Takes the '?' from as many optional operands as are there; false: the number is wrong.
  static bool LeaveOut(std::vector<std::string_view>& wanted, size_t written) {
    size_t needed = 0;
    for (const auto w : wanted) needed += w.front() != '+' && w.back() != '?';
    for (auto& w : wanted)
      if (w.back() == '?' && needed < written) {
        w.remove_suffix(1);
        ++needed;
      }
    return needed == written;
  }

  static std::string Usage(const Opcode& opcode) {
    std::string out;
    for (const auto operand : SplitWords(opcode.operands)) {
      if (operand.front() == '+') continue;
      const bool optional = operand.back() == '?';
      out += Format("{}{}{}{}", out.empty() ? "" : ", ", optional ? "[" : "",
                    OperandInWords(operand), optional ? "]" : "");
    }
    return out.empty() ? "none" : out;
  }

  // access: 'w', 'r' or 'u'.
  static void Touch(Instruction& instruction, char access, uint32_t reg) {
    if (access != 'w') instruction.reads.Add(reg);
    if (access != 'r') instruction.writes.Add(reg);
  }

  static void AddSpecial(Instruction& instruction, std::string_view operand) {
    const uint32_t reg = operand[2] == 'T' ? kPpeCount : operand[2] == 'L' ? kPpeLink : kPpeCr;
    Touch(instruction, operand[1], reg);
  }

  bool ReadOperand(Instruction& instruction, const Opcode& opcode, std::string_view operand,
                   std::string_view text) {
    const char kind = operand.front();
    switch (kind) {
      case 'i':
        return ReadImmediate(opcode, text);
      case 'l':
      case 'h':
        if (text.empty()) return FailOperand(opcode, text, "a label");
        references_.push_back({uint32_t(listing_.program.size()), kind == 'h', text});
        return true;
      case 'n':
        return ReadChannel(opcode, text);
      case 'k':
        return ReadConditionBit(instruction, opcode, text);
      case 'm':
      case 'M':
        return ReadMemory(instruction, opcode, operand, text);
      default:
        return ReadRegisterOperand(instruction, opcode, operand, text);
    }
  }

  bool FailOperand(const Opcode& opcode, std::string_view found, std::string_view expected) {
    return Fail(Format("'{}' in '{}'; expected {}", Shown(found), opcode.mnemonic, expected));
  }

  bool ReadImmediate(const Opcode& opcode, std::string_view text) {
    const bool looks_like_register =
        text.starts_with('$') || text.starts_with('%') || text.find("($") != text.npos;
    if (text.empty() || looks_like_register)
      return FailOperand(opcode, text, "an immediate: a number, a symbol or an expression");
    return true;
  }

  bool ReadChannel(const Opcode& opcode, std::string_view text) {
    std::string_view digits = text;
    if (digits.starts_with('$')) digits.remove_prefix(1);
    if (digits.starts_with("ch")) digits.remove_prefix(2);
    const bool named = digits.starts_with("MFC_") || digits.starts_with("SPU_");
    const auto number = ParseInteger(digits);
    if (!named && (!number || *number < 0 || *number > 127))
      return FailOperand(opcode, text, "a channel, $ch0 to $ch127");
    return true;
  }

  // "4*cr7+eq", "cr7" or the number of a bit.
  bool ReadConditionBit(Instruction& instruction, const Opcode& opcode, std::string_view text) {
    const size_t at = text.find("cr");
    uint32_t field = 0;
    if (at != text.npos) {
      if (at + 2 >= text.size() || text[at + 2] < '0' || text[at + 2] > '7')
        return FailOperand(opcode, text, "a condition field, cr0 to cr7");
      field = uint32_t(text[at + 2] - '0');
    } else if (const auto bit = ParseInteger(text)) {
      if (*bit < 0 || *bit > 31) return FailOperand(opcode, text, "a condition bit, 0 to 31");
      field = uint32_t(*bit) / 4;
    } else if (text != "lt" && text != "gt" && text != "eq" && text != "so" && text != "un") {
      return FailOperand(opcode, text, "a condition bit such as 2, eq or 4*cr7+eq");
    }
    instruction.reads.Add(kPpeCr + field);
    return true;
  }

  const RegisterFile& File(char letter) const {
    for (const RegisterFile& file : listing_.set->files)
      if (file.letter == letter) return file;
    return listing_.set->files[0];  // '0' is the general file
  }

  // False, and the error is set, when it is none.
  bool ReadRegister(const Opcode& opcode, char letter, std::string_view text, uint32_t& reg) {
    const RegisterFile& file = File(letter);
    std::string_view digits = text;
    if (letter == 's' && (digits == "$sp" || digits == "sp")) digits = "1";
    if (letter == 's' && (digits == "$lr" || digits == "lr")) digits = "0";
    for (const std::string_view prefix : SplitWords(file.prefixes))
      if (digits.starts_with(prefix)) {
        digits.remove_prefix(prefix.size());
        break;
      }
    const bool is_number = !digits.empty() && std::ranges::all_of(digits, IsDigit);
    const int64_t number = is_number ? ParseInteger(digits).value_or(file.count) : file.count;
    const std::string_view prefix = file.prefixes.substr(file.prefixes.rfind(' ') + 1);
    if (number >= file.count)
      return FailOperand(opcode, text,
                         Format("a {}, {}0 to {}{}{}", file.name, prefix, prefix, file.count - 1,
                                letter == 's' ? " (or $0, or 0)" : ""));
    reg = file.first + uint32_t(number);
    return true;
  }

  bool ReadRegisterOperand(Instruction& instruction, const Opcode& opcode, std::string_view operand,
                           std::string_view text) {
    uint32_t reg = 0;
    if (!ReadRegister(opcode, operand[1], text, reg)) return false;
    const bool none = operand[1] == '0' && reg == kPpeGeneral;
    switch (operand[0]) {
      case 'b':
      case 'B':
        SetBase(instruction, operand[0] == 'B', none ? kNoRegister : reg);
        break;
      case 'x':
        instruction.address.index = reg;
        instruction.reads.Add(reg);
        break;
      default:
        if (!none) Touch(instruction, operand[0], reg);
    }
    return true;
  }

  static void SetBase(Instruction& instruction, bool updated, uint32_t reg) {
    instruction.address.base = reg;
    if (reg == kNoRegister) return;
    Touch(instruction, updated ? 'u' : 'r', reg);
  }

  bool ReadMemory(Instruction& instruction, const Opcode& opcode, std::string_view operand,
                  std::string_view text) {
    const size_t open = text.rfind('(');
    if (open == text.npos || text.back() != ')')
      return FailOperand(opcode, text, "a memory operand such as 16($3)");
    uint32_t reg = 0;
    if (!ReadRegister(opcode, operand[1], Trim(text.substr(open + 1, text.size() - open - 2)), reg))
      return false;
    const std::string_view offset = Trim(text.substr(0, open));
    if (offset.starts_with('$') || offset.starts_with('%'))
      return FailOperand(opcode, text, "an offset that is a number or a symbol");
    const bool none = operand[1] == '0' && reg == kPpeGeneral;
    SetBase(instruction, operand[0] == 'M', none ? kNoRegister : reg);
    const int64_t number = offset.empty() ? 0 : ParseInteger(offset).value_or(INT64_MAX);
    if (number >= INT32_MIN && number <= INT32_MAX)
      instruction.address.displacement_bytes = int32_t(number);
    else
      instruction.address.size_bytes = 0;  // a symbol: the address is not known by its text
    return true;
  }

  bool ResolveReferences() {
    for (const Reference& reference : references_) {
      const auto index = Resolve(reference);
      line_ = listing_.line[reference.instruction];
      if (!index) {
        std::string names;
        for (size_t l = 0; l < std::min<size_t>(listing_.labels.size(), 8); ++l)
          names += Format("{}{}", l ? ", " : "", listing_.labels[l].name);
        return Fail(Format("no place '{}' in this listing; expected one of its labels{}{}",
                           Shown(reference.operand), names.empty() ? "" : ": ", names));
      }
      Instruction& instruction = listing_.program[reference.instruction];
      (reference.is_hinted_branch ? instruction.hinted : instruction.target) = *index;
    }
    return true;
  }

  std::optional<uint32_t> Resolve(const Reference& reference) const {
    const std::string_view text = reference.operand;
    if (text.front() == '.' && (text.size() == 1 || text[1] == '+' || text[1] == '-'))
      return ResolveRelative(reference.instruction, text.substr(1));
    const std::string_view digits = text.substr(0, text.size() - 1);
    if ((text.back() == 'b' || text.back() == 'f') && !digits.empty() &&
        std::ranges::all_of(digits, IsDigit))
      return ResolveNumeric(reference.instruction, digits, text.back() == 'b');
    const auto label = places_.find(text);
    return label == places_.end() ? std::nullopt : std::optional(label->second[0]);
  }

  std::optional<uint32_t> ResolveRelative(uint32_t from, std::string_view offset) const {
    if (offset.starts_with('+')) offset.remove_prefix(1);
    const auto bytes = offset.empty() ? std::optional<int64_t>(0) : ParseInteger(offset);
    if (!bytes || *bytes % kInstructionBytes != 0) return std::nullopt;
    const int64_t words = *bytes / int64_t{kInstructionBytes};
    if (words < -int64_t{from} || words > int64_t(listing_.program.size()) - int64_t{from})
      return std::nullopt;
    return uint32_t(int64_t{from} + words);
  }

  // The nearest label of that number before or behind the instruction.
  std::optional<uint32_t> ResolveNumeric(uint32_t from, std::string_view digits,
                                         bool backward) const {
    const auto label = places_.find(digits);
    if (label == places_.end()) return std::nullopt;
    const std::vector<uint32_t>& places = label->second;
    const auto behind = std::ranges::upper_bound(places, from);
    if (backward) return behind == places.begin() ? std::nullopt : std::optional(*(behind - 1));
    return behind == places.end() ? std::nullopt : std::optional(*behind);
  }

  std::string& error_;
  Listing listing_;
  std::vector<Reference> references_;
  std::map<std::string, std::vector<uint32_t>, std::less<>> places_;  // of each label, ascending
  uint32_t line_ = 1;
};

}  // namespace

const ListingLabel* Listing::FindLabel(std::string_view label) const {
  for (const ListingLabel& l : labels)
    if (l.name == label) return &l;
  return nullptr;
}

Result<Listing> ReadListing(std::string_view text, std::string_view name,
                            const InstructionSet& set) {
  std::string error;
  std::optional<Listing> listing = ListingReader(name, set, error).Read(text);
  if (!listing) return Failure{error};
  return *std::move(listing);
}

}  // namespace pelt
