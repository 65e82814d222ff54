# How far apt or pip is, from its output: one line. apt tells the share (APT::Status-Fd=1), in the words of its user's
# language; pip names each package before it fetches it, and `count` is the number of those that it was asked for.
{ sub(/\r+$/, ""); sub(/.*\r/, "") }
/^[ \t]*$/ { next }
/^(dl|pm)status:/ {
  split($0, part, ":")
  sub(/^[^:]*:[^:]*:[^:]*:/, "")
  share = sprintf("%s %d %%: %s", part[1] == "dlstatus" ? "downloaded" : "installed", part[3], $0)
  next
}
/^Ignoring / { count-- }
/^(Collecting|Requirement already satisfied)/ { named++ }
{ sub(/^ +/, ""); line = $0 }
END { print share != "" ? share : (named && count >= named ? named " of " count " packages: " : "") line }
