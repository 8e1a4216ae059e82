#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

namespace palpate::test {

/// Returns the complete answer of a server on this machine to `request`, up to the end of the
/// connection; empty if nobody listens on the port.
inline std::string httpAnswer(int port, const std::string& request) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) {
    // The server may refuse before it has read everything.
    static_cast<void>(send(socket, request.data(), request.size(), MSG_NOSIGNAL));
    char buffer[4096];
    for (ssize_t count = 0; (count = recv(socket, buffer, sizeof buffer, 0)) > 0;)
      answer.append(buffer, static_cast<std::size_t>(count));
  }
  close(socket);
  return answer;
}

/// Returns the complete answer to GET `path`; each of `headers` ends with \r\n.
inline std::string httpGet(int port, const std::string& path, const std::string& headers = "") {
  const std::string host =
      headers.find("Host:") == std::string::npos ? "Host: localhost\r\n" : std::string();
  return httpAnswer(port,
                    "GET " + path + " HTTP/1.1\r\n" + host + headers + "Connection: close\r\n\r\n");
}

/// The part after the headers.
inline std::string bodyOf(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? "" : answer.substr(end + 4);
}

}  // namespace palpate::test
