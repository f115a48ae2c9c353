#include "states/discrete.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace tachk::states {

using program::SlotSet;

namespace {

static_assert(std::endian::native == std::endian::little);  // half of a word is its first four bytes

std::uint64_t hash_words(const std::uint64_t* words, std::size_t count) {
  std::uint64_t hash = 0x9E3779B97F4A7C15u;
  for (std::size_t n = 0; n < count; ++n) {
    hash = (hash ^ words[n]) * 0xD6E8FEB86659FD93u;
    hash ^= hash >> 32;
  }
  hash *= 0xD6E8FEB86659FD93u;
  return hash ^ (hash >> 29);
}

// Chunks have a dozen or some dozen slots: too few for a call of memcmp to pay.
bool same_slots(const std::int32_t* a, const std::int32_t* b, std::size_t count) {
  std::size_t n = 0;
  for (; n + 4 <= count; n += 4) {
    std::uint64_t x[2];
    std::uint64_t y[2];
    std::memcpy(x, a + n, sizeof(x));
    std::memcpy(y, b + n, sizeof(y));
    if (((x[0] ^ y[0]) | (x[1] ^ y[1])) != 0) return false;
  }
  for (; n < count; ++n)
    if (a[n] != b[n]) return false;
  return true;
}

}  // namespace

StateLayout::StateLayout(const program::Program& program) {
  std::uint32_t used = 0;  // bits of the current word
  std::uint32_t word = 0;
  first_field_.push_back(0);
  for (std::uint32_t s = 0; s < program.state_slots; ++s) {
    const program::Slot& slot = program.slots[s];
    initial_.push_back(slot.initial);
    const auto span = static_cast<std::uint64_t>(static_cast<std::int64_t>(slot.high) - slot.low);
    if (slot.meta || span == 0) continue;
    const auto bits = static_cast<std::uint32_t>(std::bit_width(span));
    if (used + bits > 64) {
      ++word;
      used = 0;
      first_field_.push_back(fields_.size());
    }
    fields_.push_back({s, word, used, (std::uint64_t{1} << bits) - 1, slot.low});
    used += bits;
  }
  first_field_.push_back(fields_.size());
  words_ = word + 1;
  bits_ = 64 * std::size_t{word} + used;
}

void StateLayout::pack(const std::int32_t* slots, std::size_t first, std::size_t last, std::uint64_t* words) const {
  for (std::size_t word = first; word < last; ++word) {
    std::uint64_t packed = 0;
    for (std::size_t n = first_field_[word]; n < first_field_[word + 1]; ++n) {
      const Field& f = fields_[n];
      packed |= static_cast<std::uint64_t>(static_cast<std::int64_t>(slots[f.slot]) - f.low) << f.shift;
    }
    words[word - first] = packed;
  }
}

void StateLayout::unpack(const std::uint64_t* words, std::size_t first, std::size_t last, std::int32_t* slots) const {
  for (std::size_t n = first_field_[first]; n < first_field_[last]; ++n) {
    const Field& f = fields_[n];
    const std::uint64_t value = (words[f.word - first] >> f.shift) & f.mask;
    slots[f.slot] = static_cast<std::int32_t>(static_cast<std::int64_t>(value) + f.low);
  }
}

std::size_t StateLayout::first_slot(std::size_t word) const {
  return first_field_[word] < fields_.size() ? fields_[first_field_[word]].slot : initial_.size();
}

DiscreteStates::DiscreteStates(const program::Program& program, std::size_t chunk_words)
    : layout_(program),
      chunk_words_(layout_.words() > 2 * chunk_words ? chunk_words : 0),
      key_bytes_((layout_.bits() + 31) / 32 * sizeof(std::uint32_t)),
      records_(note_bytes + key_bytes_),
      chunks_(sizeof(std::uint64_t)) {
  if (chunk_words_ != 0) {
    for (std::size_t word = 0; word < layout_.words(); word += chunk_words_)
      chunk_slots_.push_back(layout_.first_slot(word));
    const std::size_t chunks = chunk_slots_.size();
    chunk_slots_.push_back(layout_.slots());
    chunk_members_.resize(chunks);
    for (std::size_t chunk = 0; chunk < chunks; ++chunk)
      for (std::size_t slot = chunk_slots_[chunk]; slot < chunk_slots_[chunk + 1]; ++slot)
        chunk_members_[chunk].add(slot);
    narrow_key_.resize((chunks + 1) / 2 * 2);
    key_bytes_ = narrow_key_.size() * sizeof(std::uint16_t);
    records_ = RecordPool(note_bytes + key_bytes_);
    chunks_ = RecordPool(chunk_words_ * sizeof(std::uint64_t));
  }
  key_.assign(chunk_words_ == 0 ? layout_.words() : chunk_slots_.size() / 2, 0);
  packed_.resize(chunk_words_ == 0 ? layout_.words() : chunk_words_);
}

void DiscreteStates::make_key(const std::int32_t* slots, const SlotSet& written) {
  if (chunk_words_ == 0) {
    layout_.pack(slots, 0, layout_.words(), key_.data());
    return;
  }
  for (std::size_t chunk = 0; chunk + 1 < chunk_slots_.size(); ++chunk) {
    const std::size_t first = chunk_slots_[chunk];
    const std::size_t count = chunk_slots_[chunk + 1] - first;
    std::uint32_t number;
    if (!known_chunks_.empty() &&
        (!written.meets(chunk_members_[chunk]) || same_slots(slots + first, known_slots_.data() + first, count))) {
      number = known_chunks_[chunk];
    } else {
      const std::size_t word = chunk * chunk_words_;
      const std::size_t last = std::min(word + chunk_words_, layout_.words());
      std::fill(packed_.begin(), packed_.end(), 0);
      layout_.pack(slots, word, last, packed_.data());
      number = intern_chunk();
    }
    std::memcpy(reinterpret_cast<std::byte*>(key_.data()) + chunk * sizeof(number), &number, sizeof(number));
    if (!narrow_key_.empty()) narrow_key_[chunk] = static_cast<std::uint16_t>(number);
  }
}

std::uint32_t DiscreteStates::chunk_number(const std::byte* key, std::size_t chunk) const {
  if (narrow_key_.empty()) {
    std::uint32_t number;
    std::memcpy(&number, key + chunk * sizeof(number), sizeof(number));
    return number;
  }
  std::uint16_t number;
  std::memcpy(&number, key + chunk * sizeof(number), sizeof(number));
  return number;
}

void DiscreteStates::widen_numbers() {
  const std::size_t chunks = chunk_slots_.size() - 1;
  const std::size_t wide_bytes = chunks * sizeof(std::uint32_t);
  RecordPool wide(note_bytes + wide_bytes);
  for (std::uint32_t record = 0; record < records_.size(); ++record) {
    std::byte* const to = wide[wide.append()];
    std::memcpy(to, records_[record], note_bytes);
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      const std::uint32_t number = chunk_number(key_of(record), chunk);
      std::memcpy(to + note_bytes + chunk * sizeof(number), &number, sizeof(number));
    }
  }
  records_ = std::move(wide);
  key_bytes_ = wide_bytes;
  narrow_key_.clear();
}

std::uint32_t DiscreteStates::intern_chunk() {
  const std::uint64_t hash = hash_words(packed_.data(), chunk_words_);
  const std::uint32_t found = chunk_index_.find(hash, [&](std::uint32_t number) {
    return std::memcmp(chunks_[number], packed_.data(), chunk_words_ * sizeof(std::uint64_t)) == 0;
  });
  if (found != HashIndex::absent) return found;
  const std::uint32_t fresh = chunks_.append();
  if (fresh > UINT16_MAX && !narrow_key_.empty()) widen_numbers();
  std::memcpy(chunks_[fresh], packed_.data(), chunk_words_ * sizeof(std::uint64_t));
  chunk_index_.insert(hash, fresh);
  return fresh;
}

void DiscreteStates::announce(const std::int32_t* slots, const SlotSet& written) {
  make_key(slots, written);
  hash_ = hash_words(key_.data(), key_.size());
  index_.prefetch(hash_);
}

std::uint32_t DiscreteStates::locate(std::uint32_t fresh_note) {
  const std::uint32_t found = index_.find(hash_, [this](std::uint32_t number) { return has_key(number); });
  if (found != HashIndex::absent) return found;
  const std::uint32_t fresh = records_.append();
  std::memcpy(records_[fresh] + note_bytes, held_key(), key_bytes_);
  note(fresh) = fresh_note;
  index_.insert(hash_, fresh);
  return fresh;
}

bool DiscreteStates::equals(std::uint32_t number, const std::int32_t* slots) {
  make_key(slots, SlotSet::all());
  return has_key(number);
}

void DiscreteStates::unpack(std::uint32_t number, std::int32_t* slots) {
  const std::vector<std::int32_t>& initial = layout_.initial();
  if (chunk_words_ == 0) {
    std::memcpy(slots, initial.data(), initial.size() * sizeof(std::int32_t));
    std::memcpy(packed_.data(), key_of(number), key_bytes_);
    layout_.unpack(packed_.data(), 0, layout_.words(), slots);
    return;
  }
  const std::size_t chunks = chunk_slots_.size() - 1;
  if (known_chunks_.empty()) {
    known_slots_ = initial;
    known_chunks_.assign(chunks, HashIndex::absent);
  }
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
    const std::uint32_t stored = chunk_number(key_of(number), chunk);
    if (std::exchange(known_chunks_[chunk], stored) == stored) continue;
    const std::size_t word = chunk * chunk_words_;
    const std::size_t last = std::min(word + chunk_words_, layout_.words());
    layout_.unpack(reinterpret_cast<const std::uint64_t*>(chunks_[stored]), word, last, known_slots_.data());
  }
  std::memcpy(slots, known_slots_.data(), known_slots_.size() * sizeof(std::int32_t));
}

}  // namespace tachk::states
