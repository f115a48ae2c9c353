// `tachkc` is `tachk` by way of its server, without a start of Python: docs/server.md. It does what
// src/tachk/cli/server/client.py does; where no server fits it becomes the `tachk` beside it.
#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

extern char** environ;

namespace {

constexpr const char* inherited[] = {"PYTHON",  "LC_",    "LANG", "LD_",       "DYLD_",
                                     "MALLOC_", "GLIBC_", "OMP_", "OPENBLAS_", "MKL_"};
constexpr const char* not_for_server[] = {"serve", "mcp", "step", "proxy", "bridge"};
constexpr const char* of_a_process[] = {"/dev/fd/", "/dev/tty", "/proc/"};
constexpr const char* namespaces[] = {"/proc/self/ns/mnt", "/proc/self/ns/pid", "/proc/self/ns/net"};
constexpr int handed_on[] = {SIGINT, SIGTERM, SIGTSTP};

int connection = -1;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// The number of bytes of the character of UTF-8 at the beginning of a text; 0 if there is none.
size_t character(std::string_view text) {
  const auto byte = [&](size_t n) { return static_cast<unsigned char>(text[n]); };
  const size_t size = byte(0) < 0x80 ? 1 : byte(0) < 0xC2 ? 0 : byte(0) < 0xE0 ? 2 : byte(0) < 0xF0 ? 3 : 4;
  if (size == 0 || size > text.size() || byte(0) > 0xF4) return 0;
  for (size_t n = 1; n < size; ++n) {
    if ((byte(n) & 0xC0) != 0x80) return 0;
  }
  const bool too_long = (byte(0) == 0xE0 && byte(1) < 0xA0) || (byte(0) == 0xF0 && byte(1) < 0x90);
  const bool no_character = (byte(0) == 0xED && byte(1) > 0x9F) || (byte(0) == 0xF4 && byte(1) > 0x8F);
  return too_long || no_character ? 0 : size;
}

/// A text of JSON. Bytes that are no characters become what Python makes of them.
std::string quoted(std::string_view text) {
  std::string made = "\"";
  while (!text.empty()) {
    const size_t size = character(text);
    const auto first = static_cast<unsigned char>(text[0]);
    if (size == 0 || first < 0x20 || first == '"' || first == '\\') {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04x", size == 0 ? 0xDC00 + first : first);
      made += escaped;
    } else {
      made += text.substr(0, size);
    }
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return made + '"';
}

std::string target_of(const char* link) {
  char target[4096];
  const ssize_t size = readlink(link, target, sizeof target);
  return size < 0 ? "" : std::string(target, static_cast<size_t>(size));
}

/// `identity.key_of_scripts` of the folder of this program.
std::string key(const std::string& folder) {
  std::vector<std::string> started;
  for (char** each = environ; *each; ++each) {
    for (const char* name : inherited) {
      if (std::strncmp(*each, name, std::strlen(name)) == 0 && std::strchr(*each, '=')) started.emplace_back(*each);
    }
  }
  std::sort(started.begin(), started.end());
  gid_t groups[1024];
  const int count = std::max(0, getgroups(1024, groups));
  std::sort(groups, groups + count);
  struct stat root{};
  stat("/", &root);
  std::string made = TACHK_VERSION "\n" + folder;
  for (const std::string& each : started) made += "\n" + each;
  made += "\n" + std::to_string(getuid()) + " " + std::to_string(getgid());
  for (int n = 0; n < count; ++n) made += " " + std::to_string(groups[n]);
  made += "\n" + std::to_string(root.st_dev) + " " + std::to_string(root.st_ino);
  for (const char* space : namespaces) made += "\n" + target_of(space);
  return made;
}

std::string usual_socket(const std::string& of) {
  unsigned sum = ~0U;
  for (const char byte : of) {
    sum ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ (sum & 1 ? 0xEDB88320U : 0);
  }
  char name[16];
  std::snprintf(name, sizeof name, "/%08x.sock", ~sum);
  const std::string runtime = variable("XDG_RUNTIME_DIR"), temporary = variable("TMPDIR");
  struct stat found{};
  if (runtime.starts_with('/') && stat(runtime.c_str(), &found) == 0 && found.st_uid == getuid())
    return runtime + (runtime.ends_with('/') ? "tachk" : "/tachk") + name;
  return (temporary.empty() ? "/tmp" : temporary) + "/tachk-" + std::to_string(getuid()) + name;
}

bool is_work_for_server(int count, char** words) {
  for (int number = 0; number < 3; ++number) {
    if (fcntl(number, F_GETFD) < 0) return false;
  }
  for (int n = 1; n < count; ++n) {
    const std::string_view word = words[n];
    for (const char* name : not_for_server) {
      if (n <= 2 && word == name) return false;
    }
    for (const char* path : of_a_process) {
      if (word.find(path) != word.npos) return false;
    }
  }
  return true;
}

bool connected(const std::string& path) {
  struct stat folder{};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const size_t slash = path.rfind('/');
  if (slash == path.npos || path.size() >= sizeof address.sun_path) return false;
  if (lstat(path.substr(0, slash).c_str(), &folder) != 0 || !S_ISDIR(folder.st_mode)) return false;
  if (folder.st_uid != getuid() || folder.st_mode & 077) return false;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  connection = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ucred other{};
  socklen_t size = sizeof other;
  return connection >= 0 && connect(connection, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
         getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &other, &size) == 0 && other.uid == getuid();
}

bool is_ignored(int number) {
  struct sigaction now{};
  sigaction(number, nullptr, &now);
  return now.sa_handler == SIG_IGN;
}

std::string request(int count, char** words, const std::string& own) {
  const mode_t mask = umask(077);
  umask(mask);
  std::string argv, variables, ignored;
  for (int n = 1; n < count; ++n) argv += (n > 1 ? "," : "") + quoted(words[n]);
  for (char** each = environ; *each; ++each) {
    const std::string_view entry = *each;
    const size_t equal = entry.find('=');
    if (equal == entry.npos) continue;
    variables +=
        (variables.empty() ? "" : ",") + quoted(entry.substr(0, equal)) + ":" + quoted(entry.substr(equal + 1));
  }
  for (const auto& [name, number] : {std::pair{"SIGHUP", SIGHUP}, {"SIGINT", SIGINT}, {"SIGTERM", SIGTERM}}) {
    if (is_ignored(number)) ignored += (ignored.empty() ? "" : ",") + quoted(name);
  }
  char* here = getcwd(nullptr, 0);
  const std::string folder = here ? here : "";  // which the server rejects
  std::free(here);
  return "{\"id\":1,\"argv\":[" + argv + "],\"cwd\":" + quoted(folder) + ",\"environment\":{" + variables +
         "},\"umask\":" + std::to_string(mask) + ",\"ignored\":[" + ignored + "],\"key\":" + quoted(own) +
         ",\"descriptors\":true}\n";
}

/// Sends a text and the standard streams.
bool sent(std::string_view text) {
  const int streams[] = {0, 1, 2};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof streams)] = {};
  iovec data{const_cast<char*>(text.data()), text.size()};
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  cmsghdr* header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(sizeof streams);
  std::memcpy(CMSG_DATA(header), streams, sizeof streams);
  ssize_t done = sendmsg(connection, &message, MSG_NOSIGNAL);
  while (done > 0 && static_cast<size_t>(done) < text.size()) {
    text.remove_prefix(static_cast<size_t>(done));
    done = send(connection, text.data(), text.size(), MSG_NOSIGNAL);
  }
  return done > 0;
}

void say_signal(int number) {
  char line[] = "{\"id\":1,\"signal\":00}\n";
  line[17] = static_cast<char>('0' + number / 10 % 10);
  line[18] = static_cast<char>('0' + number % 10);
  // JSON has no number that begins with 0.
  if (number < 10) line[17] = ' ';
  [[maybe_unused]] const ssize_t size = send(connection, line, sizeof line - 1, MSG_NOSIGNAL);
}

void hand_on(int number) {
  say_signal(number);
  if (number != SIGTSTP) return;
  raise(SIGSTOP);  // goes on here when the shell continues the program
  say_signal(SIGCONT);
}

/// The number behind a name in a reply; 0 if it is not there.
int number_in(const std::string& line, const char* name) {
  const size_t at = line.find(name);
  return at == line.npos ? 0 : std::atoi(line.c_str() + at + std::strlen(name));
}

[[noreturn]] void end_as(const std::string& line) {
  const int number = number_in(line, "\"signal\":");
  if (number == 0) _exit(number_in(line, "\"status\":"));
  signal(number, SIG_DFL);
  raise(number);
  _exit(128 + number);
}

/// Ends the program as the request has ended; returns if it was not even begun.
void await_end() {
  int process = 0;
  std::string received;
  char piece[4096];
  for (ssize_t size; (size = recv(connection, piece, sizeof piece, 0)) != 0;) {
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) break;
    received.append(piece, static_cast<size_t>(size));
    for (size_t end; (end = received.find('\n')) != received.npos; received.erase(0, end + 1)) {
      const std::string line = received.substr(0, end);
      if (line.find("\"status\":") != line.npos) end_as(line);
      process = number_in(line, "\"process\":");
      if (process == 0) return;
    }
  }
  if (process == 0) return;
  kill(-process, SIGKILL);
  std::fputs("error: the server has ended before the command\n", stderr);
  _exit(70);
}

void use_server(int count, char** words, const std::string& folder, const std::string& setting) {
  const std::string own = key(folder);
  if (!is_work_for_server(count, words) || !connected(setting == "auto" ? usual_socket(own) : setting)) return;
  sigset_t held, before;
  sigemptyset(&held);
  for (const int number : handed_on) sigaddset(&held, number);
  sigprocmask(SIG_BLOCK, &held, &before);
  std::vector<int> replaced;
  if (sent(request(count, words, own))) {
    for (const int number : handed_on) {
      if (!is_ignored(number)) {
        signal(number, hand_on);
        replaced.push_back(number);
      }
    }
    sigprocmask(SIG_SETMASK, &before, nullptr);
    await_end();
  }
  for (const int number : replaced) signal(number, SIG_DFL);
  sigprocmask(SIG_SETMASK, &before, nullptr);
}

/// As Python does it at its start: without a language it works with UTF-8.
void choose_language() {
  const bool none = std::setlocale(LC_CTYPE, "") != nullptr && std::strcmp(std::setlocale(LC_CTYPE, nullptr), "C") == 0;
  if (none && variable("LC_ALL").empty() && variable("PYTHONCOERCECLOCALE") != "0" &&
      std::setlocale(LC_CTYPE, "C.UTF-8") != nullptr) {
    setenv("LC_CTYPE", "C.UTF-8", 1);
  }
}

}  // namespace

int main(int count, char** words) {
  const std::string program = target_of("/proc/self/exe");
  const std::string folder = program.substr(0, program.rfind('/'));
  if (variable("TACHK_SERVER").empty()) setenv("TACHK_SERVER", "auto", 1);
  const std::string setting = variable("TACHK_SERVER");
  if (setting != "off") {
    choose_language();
    use_server(count, words, folder, setting);
  }
  const std::string tachk = folder + "/tachk";
  words[0] = const_cast<char*>(tachk.c_str());
  execv(tachk.c_str(), words);
  std::fprintf(stderr, "error: %s: %s\n", tachk.c_str(), std::strerror(errno));
  return 2;
}
