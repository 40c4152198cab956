# tests of this topic
