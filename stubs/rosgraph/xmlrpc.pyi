import socket
from xmlrpc.server import SimpleXMLRPCRequestHandler

class SilenceableXMLRPCRequestHandler(SimpleXMLRPCRequestHandler):
    connection: socket.socket
